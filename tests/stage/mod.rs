//! The planner of the stage's motion, as its users see it.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod accuracy;
mod exact;
mod flight_direction;
mod fly_back;
mod motion;
mod planning;
mod support;
