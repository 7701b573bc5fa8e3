//! The camera's state machine, as firmware and simulator drive it.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::large_types_passed_by_value,
    reason = "tests"
)]

mod absolute_sensor;
mod bench;
mod bring_up;
mod confirmation;
mod deck;
mod document;
mod doubted;
mod findings;
mod flyable;
mod index_mark;
mod interruptions;
mod latched;
mod nominal;
mod play;
mod preparation;
mod processor_faults;
mod rows;
mod sequences;
mod shutter_faults;
mod stage_faults;
mod table;
pub(crate) mod texts;
mod trials;
