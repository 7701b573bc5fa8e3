//! What a verification, a calibration, a simulation or a budget tells its reader: tables,
//! machine-readable files, figures, pages.

pub mod arrow_field;
mod arrow_scale;
pub mod budget;
pub mod camera_status;
mod comparison;
pub mod error_plot;
pub mod figure;
pub mod five_summary;
pub mod five_table;
#[cfg(test)]
mod fixture;
pub mod flight;
pub mod frames_csv;
pub mod html;
mod length;
mod marker;
pub mod mission;
mod picture;
pub mod records;
pub mod residual_field;
pub mod residual_plot;
pub mod residuals_csv;
mod run_up;
pub mod smear;
pub mod summary;
pub mod sweep;
pub mod table;
mod verdict;
pub(crate) mod wording;
