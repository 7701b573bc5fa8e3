//! The store as a user of the crate sees it: a flash whose supply fails at any word, images of any
//! contents, flashes that are worn.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

pub(crate) mod calibrations;
mod contents;
mod cuts;
pub(crate) mod flash_model;
mod fuzzed;
pub(crate) mod grids;
pub(crate) mod images;
mod orders;
mod refusals;
mod ring;
mod short_words;
mod signatures;
pub(crate) mod signed;
mod succession;
mod texts;
mod vast;
mod wrong_rings;
