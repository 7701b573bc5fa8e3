//! Simulated calibration of the five coefficients: Yuan et al. 2012, section 4.1.

pub mod options;
pub mod result;
pub mod run;
