//! Calibration of the coefficients from observations.

pub mod five;
pub mod measurement;
pub mod residual;
mod robust_start;
mod snooping;
mod units;
