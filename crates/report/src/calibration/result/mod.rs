//! Report of a calibration, whatever its method: terminal table, files, figures, page.

pub mod coverage_plot;
mod csv_files;
pub mod files;
pub mod network_plot;
pub mod of_method;
mod page;
pub mod profile;
pub mod profile_plot;
pub mod residual_vectors;
pub mod summary;
pub mod table;
