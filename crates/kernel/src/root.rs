//! Square root in single precision.

/// Returns the square root, rounded to the nearest number; a NaN for numbers below zero.
///
/// IEEE 754 determines its bits: they are those of `libm`, which computes in whole numbers what the
/// instruction of a Cortex-M4F or M7 gives.
#[inline]
#[must_use]
pub fn sqrt(number: f32) -> f32 {
    #[cfg(hand_scheduled)]
    let root = crate::thumbv7em::sqrt(number);
    #[cfg(not(hand_scheduled))]
    let root = libm::sqrtf(number);
    root
}
