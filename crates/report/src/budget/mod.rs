//! Report of a budget: a page of text, `summary.json`, a figure and an HTML page.

pub mod bars;
mod findings;
#[cfg(test)]
mod fixture;
pub mod page;
pub mod summary;
pub mod table;
