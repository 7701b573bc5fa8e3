//! Report of statistics over random missions, and the figures that missions share with it.

pub mod coverage_plot;
pub mod html;
pub mod missions_csv;
pub mod smear_plot;
pub mod summary;
pub mod text;
