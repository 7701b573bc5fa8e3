//! Four pixels of a run.

use core::arch::aarch64::*;

use crate::resampling::pixel::{Axis, Places};
use crate::resampling::run::PLACE_BITS;

/// Pixels that are computed together.
pub(super) const FOUR: usize = 4;

/// Four pixels of a run.
pub(super) struct Four {
    pub(super) places: Places,
    /// Number of the first of them in the run.
    pub(super) pixel: i32,
    /// Sample of a row at which the first tap of each of them begins.
    pub(super) taps: [usize; FOUR],
}

impl Four {
    /// Returns the pixels from a number on; columns are counted from the sample `first`.
    #[inline(always)]
    pub(super) fn new<const C: usize>(places: Places, pixel: i32, first: usize) -> Self {
        let tap = |number: i32| (places.col.at(pixel + number) >> PLACE_BITS) as usize * C + first;
        Self {
            places,
            pixel,
            taps: [tap(0), tap(1), tap(2), tap(3)],
        }
    }

    /// Returns the places along an axis, 1/2²⁴ px.
    #[target_feature(enable = "neon")]
    #[inline]
    pub(super) fn along(&self, axis: &Axis) -> int32x4_t {
        let numbers = [0, 1, 2, 3];
        // SAFETY: four numbers of 32 bits are borrowed.
        let numbers = unsafe { vld1q_s32(numbers.as_ptr()) };
        vmlaq_n_s32(vdupq_n_s32(axis.at(self.pixel)), numbers, axis.step)
    }
}
