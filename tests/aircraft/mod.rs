//! Data of aircraft, as a user of the crate sees them: bytes in; speed, heights and time out.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod autopilots;
mod counts;
mod fuzzed;
mod instruments;
mod mavlink;
mod nmea;
mod other_readers;
mod strangers;
#[path = "../../fuzz/aircraft.rs"]
mod targets;
mod texts;
