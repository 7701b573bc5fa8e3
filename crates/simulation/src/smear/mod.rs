//! Residual smear of an exposure, which the compensation leaves, term by term.

pub mod field;
pub mod term;
