//! The residual smear of an exposure: what the compensation leaves, term by term.

pub mod field;
pub mod term;
