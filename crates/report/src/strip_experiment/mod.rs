//! Report of a strip over ground control: a table, verdicts, machine-readable files, figures and a
//! page.

pub mod convergence_plot;
pub mod ground_error_plot;
pub mod html;
mod palette;
pub mod plan;
pub mod repetitions_csv;
mod rows;
pub mod summary;
pub mod text;
pub mod verdict;
