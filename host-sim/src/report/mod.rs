//! What a verification tells its reader: a table, machine-readable files, figures and a page.

pub mod arrow_field;
mod arrow_scale;
mod comparison;
pub mod error_plot;
pub mod figure;
#[cfg(test)]
mod fixture;
pub mod frames_csv;
pub mod html;
mod length;
mod marker;
mod run_up;
pub mod summary;
pub mod table;
mod verdict;
mod wording;
