//! The kernel of a PC: vectors of the instruction set found at run time, several threads for large sets, and stores
//! past the caches for sets that do not fit.
//!
//! Nothing of this changes a bit: every lane does the operations of [`crate::portable`] in the same order, none fused.
//! (Of a NaN this holds for being one: its payload is the processor's choice.) The vectors are those of the crate
//! `pulp`: it detects instructions without the standard library, gives out a proof of them without which a kernel
//! cannot be called, and lets a test run every level that the machine has. `tests/host` says how
//! NEON's is run where the machine has none.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the instructions are enabled is compiled without them"
)]

mod batch;
mod form;
mod level;
mod pairs;
mod vectors;
mod xy;

pub use batch::{Batch, STREAMED_FROM_BYTES, THREADED_FROM_POINTS, Terms};
pub use level::Level;

use vectors::Vectors;

/// How many numbers lie before the first that is aligned to so many bytes.
#[inline(always)]
fn head(numbers: &[f32], alignment: usize) -> usize {
    let past = numbers.as_ptr().addr() % alignment;
    let before = (alignment - past) % alignment / size_of::<f32>();
    before.min(numbers.len())
}

/// The last vector of a slice.
#[inline(always)]
fn last<V: Vectors>(numbers: &[f32]) -> Option<&V::f32s> {
    V::as_rsimd_f32s(numbers).1.last()
}

/// [`last`] to write to.
#[inline(always)]
fn last_mut<V: Vectors>(numbers: &mut [f32]) -> Option<&mut V::f32s> {
    V::as_mut_rsimd_f32s(numbers).1.last_mut()
}
