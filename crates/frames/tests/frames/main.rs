//! Frames as records and tables give them, against the camera that computed them.

#![allow(
    clippy::indexing_slicing,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test fails by panicking"
)]

mod damaged;
mod pixel_covariance;
mod record_files;
mod records;
mod support;
mod table;
mod trajectory;
