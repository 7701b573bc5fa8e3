//! Report of a calibration of the five coefficients: a table, machine-readable files and figures.

pub mod five_summary;
pub mod five_table;
pub mod residual_field;
pub mod residual_plot;
pub mod residuals_csv;
