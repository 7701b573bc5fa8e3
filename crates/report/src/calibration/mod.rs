//! Reports of calibrations: tables, machine-readable files, figures and pages.

pub mod angles;
pub mod dlt2d;
mod dlt2d_figures;
pub mod dlt3d;
pub mod field_angles;
pub mod five_summary;
pub mod five_table;
pub mod grid;
pub mod record_plot;
pub mod residual_field;
pub mod residual_plot;
pub mod residuals_csv;
pub mod result;
