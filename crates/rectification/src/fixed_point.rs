//! Places in fixed point.

use fmc_camera_kernel::resampling::PLACE_BITS;

/// Bits of the fraction of a pixel in a vertex.
pub const VERTEX_BITS: u32 = 20;

/// Bits that a place has more than a vertex.
pub(crate) const MORE_BITS: u32 = PLACE_BITS - VERTEX_BITS;

/// Returns pixels in fixed point, unless they are too many.
pub(crate) fn fixed(pixels: f64) -> Option<i32> {
    let steps = (pixels * f64::from(1 << VERTEX_BITS)).round();
    (steps.abs() < f64::from(i32::MAX)).then(|| nearest(steps))
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a whole number below 2³¹ in size"
)]
pub(crate) const fn nearest(whole: f64) -> i32 {
    whole as i32
}

#[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
pub(crate) const fn single(number: f64) -> f32 {
    number as f32
}

/// Returns the last 32 bits of a number.
#[expect(clippy::cast_possible_truncation, reason = "that is the result")]
pub(crate) const fn low(number: i64) -> i32 {
    number as i32
}

/// Returns a number that is known to be small.
pub(crate) fn small(number: i64) -> i32 {
    i32::try_from(number).unwrap_or(i32::MAX)
}
