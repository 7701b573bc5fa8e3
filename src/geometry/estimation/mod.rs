//! Least squares of the five coefficients, one observation after the other.
//!
//! An [`Adjustment`](adjustment::Adjustment) takes observed distortions as they come and keeps no
//! more of them than a triangular factor of 7 x 7 numbers (twice, see
//! [`BLOCK_POINTS`](adjustment::BLOCK_POINTS)), so that a camera can refine its own coefficients in
//! flight. The same code runs in single precision on the camera and in either precision on the PC.

pub mod adjustment;
pub mod design;
pub mod fit;
pub mod known_lens;
pub mod number;
pub mod observation;
pub mod options;
pub mod parameter;
mod separability;
mod triangle;
