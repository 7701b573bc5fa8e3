//! Campaign: every fault in every round of a frame cycle, and pairs of faults.
//!
//! A flight is flown once without faults. Each run copies it where it is in a round, adds a fault
//! and flies on until the frames after it are recorded. The judge compares them with the physical
//! truth; the flight without faults tells what the fault has changed.

pub mod case;
pub mod effect;
pub mod outcome;
pub mod pair;
pub mod plan;
pub mod repeat;
pub mod results;
pub mod run;
pub mod world;
