//! Calibration of the coefficients from observations.

pub mod angles;
pub mod dlt2d;
pub mod dlt3d;
pub mod failure;
pub mod five;
pub(crate) mod gross_errors;
pub(crate) mod least_squares;
pub mod measurement;
pub mod residual;
pub mod result;
mod robust_start;
pub(crate) mod snooping;
mod units;
