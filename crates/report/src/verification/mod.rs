//! Report of a verification: a table, machine-readable files, figures and a page.

mod comparison;
pub mod distortion_field;
pub mod error_plot;
#[cfg(test)]
mod fixture;
pub mod frames_csv;
pub mod html;
mod marker;
mod run_up;
pub mod summary;
pub mod table;
mod verdict;
