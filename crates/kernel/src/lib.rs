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
//! Images are resampled on a PC by the module `resampling`.
//!
//! This is the only crate of the library with `unsafe`: it calls the assembly, in `thumbv7em.rs`,
//! and loads, stores and streams vectors, in `host` and `resampling`.

#![no_std]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]

#[cfg(all(
    feature = "resampling",
    any(target_arch = "x86_64", target_arch = "aarch64")
))]
extern crate alloc;

#[cfg(all(feature = "host", any(target_arch = "x86_64", target_arch = "aarch64")))]
pub mod host;
pub mod inverse;
pub mod portable;
#[cfg(all(
    feature = "resampling",
    any(target_arch = "x86_64", target_arch = "aarch64")
))]
pub mod resampling;
mod root;
#[cfg(hand_scheduled)]
mod thumbv7em;

pub use root::sqrt;

/// Terms of the correction that are evaluated for every point of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Terms {
    /// All terms except b₁, b₂, tx and ty: 23 floating-point operations per point.
    Short,
    /// All terms: 29.
    Full,
}

/// Coefficients of one frame: with X = x - cx, Y = y - cy, R = X² + Y² and
/// `G = k₀ + R(k₁ + R(k₂ + R·k₃)) + hx·X + hy·Y`
///
/// `x' = x - (X·G + gx·R + b₁·X + b₂·Y + tx)`,
/// `y' = y - (Y·G + gy·R + ty)`.
///
/// Lengths are in mm, coefficients in powers of it. The assembly reads them in this order; a vector
/// kernel has each of them in every lane of a `T`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Coefficients<T = f32> {
    /// cx, mm.
    pub cx: T,
    /// cy, mm.
    pub cy: T,
    /// k₀, mm⁰.
    pub k0: T,
    /// k₁, mm⁻².
    pub k1: T,
    /// k₂, mm⁻⁴.
    pub k2: T,
    /// k₃, mm⁻⁶.
    pub k3: T,
    /// hx, mm⁻¹.
    pub hx: T,
    /// hy, mm⁻¹.
    pub hy: T,
    /// gx, mm⁻¹.
    pub gx: T,
    /// gy, mm⁻¹.
    pub gy: T,
    /// b₁, mm⁰.
    pub b1: T,
    /// b₂, mm⁰.
    pub b2: T,
    /// tx, mm.
    pub tx: T,
    /// ty, mm.
    pub ty: T,
}

impl<T> Coefficients<T> {
    /// The same numbers as another type has them.
    #[expect(
        clippy::inline_always,
        reason = "within a function for vectors, which a call would leave"
    )]
    #[inline(always)]
    pub fn map<U>(self, number: impl Fn(T) -> U) -> Coefficients<U> {
        Coefficients {
            cx: number(self.cx),
            cy: number(self.cy),
            k0: number(self.k0),
            k1: number(self.k1),
            k2: number(self.k2),
            k3: number(self.k3),
            hx: number(self.hx),
            hy: number(self.hy),
            gx: number(self.gx),
            gy: number(self.gy),
            b1: number(self.b1),
            b2: number(self.b2),
            tx: number(self.tx),
            ty: number(self.ty),
        }
    }
}

/// Replaces every point (x, y), mm, of a slice by its ideal point, without b₁, b₂, tx and ty.
#[inline]
pub fn short_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    #[cfg(hand_scheduled)]
    {
        let rest = thumbv7em::short_pairs(coefficients, points);
        portable::rest(coefficients, Terms::Short, rest);
    }
    #[cfg(not(hand_scheduled))]
    portable::short_pairs(coefficients, points);
}

/// Replaces every point (x, y), mm, of a slice by its ideal point, with all terms.
#[inline]
pub fn full_pairs(coefficients: &Coefficients, points: &mut [[f32; 2]]) {
    #[cfg(hand_scheduled)]
    {
        let rest = thumbv7em::full_pairs(coefficients, points);
        portable::rest(coefficients, Terms::Full, rest);
    }
    #[cfg(not(hand_scheduled))]
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
