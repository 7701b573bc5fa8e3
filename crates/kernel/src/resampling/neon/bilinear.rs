//! Values of two taps.

use core::arch::aarch64::*;

use super::four::{FOUR, Four};
use super::samples::load_4;
use crate::resampling::run::PLACE_BITS;
use crate::resampling::sample::Sample;
use crate::resampling::weights::{UNIT, UNIT_BITS};

/// Bits of a shift, as intrinsics have them.
const SHIFT: i32 = UNIT_BITS as i32;

/// Returns the values of four pixels: of several bands a vector each, of one band the lanes of the
/// first vector.
///
/// # Safety
/// From the first tap of every pixel on, [`loaded`](super::samples::loaded) samples lie within each
/// row.
#[target_feature(enable = "neon")]
#[inline]
pub(super) unsafe fn bilinear<S: Sample, const C: usize, const N: usize>(
    four: &Four,
    rows: [&[&[S]; N]; FOUR],
) -> [int32x4_t; FOUR] {
    let half = vdupq_n_s32(1 << (UNIT_BITS - 1));
    let mut values = [half; FOUR];
    let pixels = rows.into_iter().zip(four.taps).zip(four.bilinear_weights());
    for (((rows, first), weights), value) in pixels.zip(&mut values) {
        let [above, below, ..] = rows.as_slice() else {
            return values;
        };
        // SAFETY: that of this function.
        unsafe {
            if C == 1 {
                let above = vreinterpret_s32_s16(load_4(above, first));
                let below = vreinterpret_s32_s16(load_4(below, first));
                let taps = vreinterpret_s16_s32(vzip1_s32(above, below));
                *value = vmull_s16(taps, weights);
            } else {
                let mut sum = vmlal_lane_s16::<0>(half, load_4(above, first), weights);
                sum = vmlal_lane_s16::<1>(sum, load_4(above, first + C), weights);
                sum = vmlal_lane_s16::<2>(sum, load_4(below, first), weights);
                sum = vmlal_lane_s16::<3>(sum, load_4(below, first + C), weights);
                *value = vshrq_n_s32::<SHIFT>(sum);
            }
        }
    }
    if C == 1 {
        let [a, b, c, d] = values;
        let sums = vpaddq_s32(vpaddq_s32(a, b), vpaddq_s32(c, d));
        values = [vshrq_n_s32::<SHIFT>(vaddq_s32(sums, half)); FOUR];
    }
    values
}

impl Four {
    /// Returns for each pixel the weights of the upper pair of taps and of the lower one.
    #[target_feature(enable = "neon")]
    #[inline]
    fn bilinear_weights(&self) -> [int16x4_t; FOUR] {
        const TO_UNIT: i32 = (PLACE_BITS - UNIT_BITS) as i32;
        let unit_less_one = vdupq_n_s32((1 << UNIT_BITS) - 1);
        let fraction = vshrq_n_s32::<TO_UNIT>(self.along(&self.places.col));
        let col = vandq_s32(fraction, unit_less_one);
        let fraction = vshrq_n_s32::<TO_UNIT>(self.along(&self.places.row));
        let row = vandq_s32(fraction, unit_less_one);
        let half = vdupq_n_s32(1 << (UNIT_BITS - 1));
        let both = vshrq_n_s32::<SHIFT>(vmlaq_s32(half, col, row));
        let (after, below) = (vsubq_s32(col, both), vsubq_s32(row, both));
        let here = vsubq_s32(vsubq_s32(vdupq_n_s32(i32::from(UNIT)), col), below);
        let (here, after) = (vmovn_s32(here), vmovn_s32(after));
        let (below, both) = (vmovn_s32(below), vmovn_s32(both));
        // Of each pixel the pairs, then both pairs.
        let upper = [vzip1_s16(here, after), vzip2_s16(here, after)];
        let lower = [vzip1_s16(below, both), vzip2_s16(below, both)];
        let [upper_01, upper_23] = upper.map(|pairs| vreinterpret_s32_s16(pairs));
        let [lower_01, lower_23] = lower.map(|pairs| vreinterpret_s32_s16(pairs));
        [
            vreinterpret_s16_s32(vzip1_s32(upper_01, lower_01)),
            vreinterpret_s16_s32(vzip2_s32(upper_01, lower_01)),
            vreinterpret_s16_s32(vzip1_s32(upper_23, lower_23)),
            vreinterpret_s16_s32(vzip2_s32(upper_23, lower_23)),
        ]
    }
}
