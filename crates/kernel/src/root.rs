//! Square root in single precision.

/// Returns the square root, rounded to the nearest number; a NaN for numbers below zero.
///
/// IEEE 754 determines its bits: they are those of `libm`, which computes in
/// whole numbers what Cortex-M4F and M7 do in hardware.
#[inline]
#[must_use]
pub fn sqrt(number: f32) -> f32 {
    #[cfg(hand_scheduled)]
    let root = crate::thumbv7em::sqrt(number);
    #[cfg(not(hand_scheduled))]
    let root = libm::sqrtf(number);
    root
}
