//! Report of a budget: a page of text, `summary.json`, a figure and an HTML page.

pub mod dots;
#[cfg(test)]
mod fixture;
pub mod page;
mod results;
pub mod summary;
pub mod table;
