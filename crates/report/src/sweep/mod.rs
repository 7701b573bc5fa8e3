//! Report of a sweep: a table, machine-readable files, a figure and a page.

pub mod coefficient_plot;
pub mod coefficients_csv;
#[cfg(test)]
mod fixture;
pub mod page;
mod power;
mod results;
pub mod summary;
pub mod table;
