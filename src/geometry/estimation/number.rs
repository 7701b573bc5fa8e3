//! Single and double precision behind one trait.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A precision in which an adjustment is computed: `f32` or `f64`.
///
/// Roots are those of `libm`, called by path, so that PC and camera get the same bits.
pub trait Number:
    'static
    + Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + sealed::Sealed
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

    /// Converts `value`, exactly.
    fn of(value: f32) -> Self;

    /// Converts the whole number `count`, rounded to this precision.
    fn of_count(count: u32) -> Self;

    /// Converts this number to single precision.
    fn single(self) -> f32;

    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// The absolute value.
    #[must_use]
    fn abs(self) -> Self;
}

impl Number for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn of(value: f32) -> Self {
        value
    }

    #[expect(clippy::cast_precision_loss, reason = "a rounded count is as good")]
    fn of_count(count: u32) -> Self {
        count as Self
    }

    fn single(self) -> f32 {
        self
    }

    fn sqrt(self) -> Self {
        fmc_camera_kernel::sqrt(self)
    }

    fn abs(self) -> Self {
        libm::fabsf(self)
    }
}

impl Number for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    fn of(value: f32) -> Self {
        Self::from(value)
    }

    fn of_count(count: u32) -> Self {
        Self::from(count)
    }

    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    fn single(self) -> f32 {
        self as f32
    }

    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    fn abs(self) -> Self {
        libm::fabs(self)
    }
}
