//! Report of a campaign of faults.

pub mod html;
pub mod rows_csv;
pub mod runs_csv;
pub mod summary;
pub mod text;
