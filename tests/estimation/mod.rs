//! The adjustment of the five coefficients as a user of the crate sees it.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod coverage;
mod degenerate;
mod dense;
mod noise_free;
mod options;
mod simulated;
