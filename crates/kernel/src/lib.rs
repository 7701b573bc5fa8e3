//! Point kernel of `fmc-camera`: it converts many measured points into ideal ones with the
//! coefficients of one frame.
//!
//! There are two forms, of which the short one leaves out b₁, b₂, tx and ty, over two layouts,
//! pairs (x, y) and separate x and y. On Cortex-M4F and M7 (`thumbv7em-none-eabihf`) they are
//! scheduled by hand in `thumbv7em.s`. Everywhere else, and for the points left over from whole
//! blocks there, they are [`portable`], which a compiler puts into the vectors of a Cortex-M55
//! (`-C target-cpu=cortex-m55`). Both perform the same operations in the same order, each rounded
//! to single precision and none fused, so that the results have the same bits, which `tests/kernel`
//! checks on emulated cores. One exception: a Cortex-M55 takes numbers below 2⁻¹²⁶ for zero.
//!
//! This is the only crate of the library with `unsafe`: it calls the assembly, in `thumbv7em.rs`,
//! and loads, stores and streams vectors, in `host`.

#![no_std]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]

#[cfg(all(feature = "host", any(target_arch = "x86_64", target_arch = "aarch64")))]
pub mod host;
pub mod portable;
#[cfg(hand_scheduled)]
mod thumbv7em;

/// Coefficients of one frame: with X = x - cx, Y = y - cy, R = X² + Y² and
/// `G = k₀ + R(k₁ + R(k₂ + R·k₃)) + hx·X + hy·Y`
///
/// `x' = x - (X·G + gx·R + b₁·X + b₂·Y + tx)`,
/// `y' = y - (Y·G + gy·R + ty)`.
///
/// Lengths are in mm, coefficients in powers of it. The assembly reads them in this order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Coefficients {
    /// cx, mm.
    pub cx: f32,
    /// cy, mm.
    pub cy: f32,
    /// k₀, mm⁰.
    pub k0: f32,
    /// k₁, mm⁻².
    pub k1: f32,
    /// k₂, mm⁻⁴.
    pub k2: f32,
    /// k₃, mm⁻⁶.
    pub k3: f32,
    /// hx, mm⁻¹.
    pub hx: f32,
    /// hy, mm⁻¹.
    pub hy: f32,
    /// gx, mm⁻¹.
    pub gx: f32,
    /// gy, mm⁻¹.
    pub gy: f32,
    /// b₁, mm⁰.
    pub b1: f32,
    /// b₂, mm⁰.
    pub b2: f32,
    /// tx, mm.
    pub tx: f32,
    /// ty, mm.
    pub ty: f32,
}

/// Replaces every point (x, y), mm, of a slice by its ideal point, without b₁, b₂, tx and ty.
#[inline]
pub fn short_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    #[cfg(hand_scheduled)]
    let points = thumbv7em::short_pairs(coefficients, points);
    portable::short_pairs(coefficients, points);
}

/// Replaces every point (x, y), mm, of a slice by its ideal point, with all terms.
#[inline]
pub fn full_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    #[cfg(hand_scheduled)]
    let points = thumbv7em::full_pairs(coefficients, points);
    portable::full_pairs(coefficients, points);
}

/// Performs [`short_pairs`] for x and y, mm, in separate slices; the rest of the longer one stays
/// as it is.
#[inline]
pub fn short_xy(coefficients: &Coefficients, x_mm: &mut [f32], y_mm: &mut [f32]) {
    #[cfg(hand_scheduled)]
    let (x_mm, y_mm) = thumbv7em::short_xy(coefficients, x_mm, y_mm);
    portable::short_xy(coefficients, x_mm, y_mm);
}

/// Performs [`full_pairs`] for x and y, mm, in separate slices; the rest of the longer one stays as
/// it is.
#[inline]
pub fn full_xy(coefficients: &Coefficients, x_mm: &mut [f32], y_mm: &mut [f32]) {
    #[cfg(hand_scheduled)]
    let (x_mm, y_mm) = thumbv7em::full_xy(coefficients, x_mm, y_mm);
    portable::full_xy(coefficients, x_mm, y_mm);
}
