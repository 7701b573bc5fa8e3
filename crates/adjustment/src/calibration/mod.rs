//! Calibration of the coefficients from observations.

pub mod angles;
pub mod dlt2d;
pub mod dlt3d;
pub mod failure;
pub mod field_angles;
pub mod five;
mod gross_errors;
mod least_squares;
pub mod measurement;
pub mod residual;
pub mod result;
mod robust_start;
pub(crate) mod snooping;
mod units;
