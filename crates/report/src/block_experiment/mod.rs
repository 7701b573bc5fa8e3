//! Report of blocks with and without the records of the flight.

pub mod check_point_plot;
mod findings;
pub mod html;
pub mod runs_csv;
pub mod summary;
pub mod text;
