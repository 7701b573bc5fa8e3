//! Residual smear of an exposure, which the compensation leaves, term by term.

#[cfg(feature = "full")]
pub mod field;
pub mod term;
