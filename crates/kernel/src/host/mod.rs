//! Kernel of a PC: vectors of the instruction set found at run time, several threads for large
//! sets, and stores past the caches for sets that do not fit into them.
//!
//! The results have the bits of [`crate::portable`]: every lane performs its operations in the same
//! order, none of them fused. (A NaN stays a NaN, but the processor chooses its payload.) The
//! vectors are those of the crate `pulp`: it detects instructions without the standard library,
//! issues a proof of them without which a kernel cannot be called, and lets a test run every level
//! that the machine has. `cargo xtask aarch64` runs the NEON level on a machine without it.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the instructions are enabled is compiled without them"
)]

mod batch;
mod distort;
mod form;
mod level;
mod pairs;
mod runs;
mod vectors;
mod xy;

pub use batch::{Batch, STREAMED_FROM_BYTES, THREADED_FROM_POINTS};
pub use level::Level;
#[cfg(feature = "resampling")]
pub(crate) use level::Token;
pub use runs::{Run, Runs};

use vectors::Vectors;

/// Counts the numbers before the first that is aligned to this many bytes.
#[inline(always)]
fn head(numbers: &[f32], alignment: usize) -> usize {
    let past = numbers.as_ptr().addr() % alignment;
    let before = (alignment - past) % alignment / size_of::<f32>();
    before.min(numbers.len())
}

/// Returns the last vector of a slice.
#[inline(always)]
fn last<V: Vectors>(numbers: &[f32]) -> Option<&V::f32s> {
    V::as_rsimd_f32s(numbers).1.last()
}

/// Returns the vector of [`last`] as mutable.
#[inline(always)]
fn last_mut<V: Vectors>(numbers: &mut [f32]) -> Option<&mut V::f32s> {
    V::as_mut_rsimd_f32s(numbers).1.last_mut()
}
