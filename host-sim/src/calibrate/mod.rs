//! Calibration: coefficients from observations.

pub mod five;
pub mod measurement;
mod robust_start;
mod snooping;
mod units;
