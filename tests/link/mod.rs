//! The link as a user of the crate sees it: bytes on the wire, and the camera's reactions.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod board;
mod bring_up;
mod conversation;
mod damage;
mod doubted_records;
mod exchange;
#[cfg(feature = "estimation")]
mod fit;
mod flown;
mod flown_requests;
mod frame_models;
mod fuzzed;
mod grids;
mod in_flight;
mod keeping;
mod loading;
mod longest_answers;
mod messages;
pub(crate) mod pc;
mod power_cuts;
mod record_copies;
mod refusals;
mod repeats;
mod resets;
mod ring_entries;
#[cfg(all(feature = "estimation", feature = "store"))]
mod schema;
mod short_streams;
#[cfg(feature = "store")]
mod stored;
#[path = "../../fuzz/targets.rs"]
mod targets;
mod temperature;
mod texts;
mod trial_bench;
mod trial_faults;
mod wired;
mod without_eyes;
mod wrong_bits;
