//! The camera's state machine, as firmware and simulator drive it.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::large_types_passed_by_value,
    reason = "tests"
)]

#[cfg(test)]
mod bench;
#[cfg(test)]
mod bring_up;
#[cfg(test)]
mod document;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod nominal;
mod sequences;
#[cfg(test)]
mod table;
