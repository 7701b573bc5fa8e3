//! Judge of records: what a camera recorded, compared with the physical truth of a simulated world.
//!
//! The truth comes from the mechanics and the scene alone: where the stage was while light passed,
//! when the light's centroid was, what image points did on the detector. Nothing of the camera's
//! own code computes it. Every quantity of a record is judged by the σ that the record states, of
//! all frames that were exposed, with and without flags and faults.

pub mod answers;
pub mod coverage;

pub mod quantity;
pub mod silence;
pub mod truth;
pub mod verdict;
