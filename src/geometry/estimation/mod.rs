//! Least squares of the five coefficients, one observation after the other.
//!
//! An `Adjustment` (module `adjustment`, feature `estimation`) takes observed distortions as they
//! come and keeps only a triangular factor of 7 x 7 numbers of them (twice, see
//! `adjustment::BLOCK_POINTS`), so that a camera can refine its own coefficients in flight. The
//! same code runs in single precision on the camera and in either precision on the PC. The types of
//! its input and output do not need the feature: a link carries them to a camera that can adjust.

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
