//! Least squares of the five coefficients, one observation after the other.
//!
//! An `Adjustment` (module `adjustment`, feature `estimation`) takes observed distortions as they come
//! and keeps no more of them than a triangular factor of 7 x 7 numbers (twice, see
//! `adjustment::BLOCK_POINTS`), so that a camera can refine its own coefficients in flight. The same
//! code runs in single precision on the camera and in either precision on the PC. What goes in and
//! what comes out is there without the feature: a link carries it to a camera that can adjust.

#[cfg(feature = "estimation")]
pub mod adjustment;
#[cfg(feature = "estimation")]
pub mod design;
#[cfg(feature = "estimation")]
mod design_rows;
pub mod fit;
#[cfg(feature = "estimation")]
pub mod known_lens;
pub mod number;
pub mod observation;
pub mod options;
pub mod parameter;
#[cfg(feature = "estimation")]
mod separability;
#[cfg(feature = "estimation")]
mod triangle;
