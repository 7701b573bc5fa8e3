//! Values of four and six taps, whose weights are in tables.

use core::arch::aarch64::*;

use super::four::{FOUR, Four};
use super::samples::{load_4, load_8};
use crate::resampling::sample::Sample;
use crate::resampling::weights::{ColumnWeights, RowWeights, Weights};

/// Returns the values of four pixels: of several bands a vector each, of one band the lanes of the
/// first vector.
///
/// # Safety
/// From the first tap of every pixel on, [`loaded`](super::samples::loaded) samples lie within each
/// row.
#[target_feature(enable = "neon")]
#[inline]
pub(super) unsafe fn tabulated<S: Sample, const C: usize, const N: usize>(
    four: &Four,
    rows: [&[&[S]; N]; FOUR],
    weights: &Weights,
) -> [int32x4_t; FOUR] {
    let (col, row) = (&four.places.col, &four.places.row);
    let of_pixel = |number: i32| {
        let pixel = four.pixel + number;
        let (along, down) = (col.fraction::<N>(pixel), row.fraction::<N>(pixel));
        (weights.along(along), weights.down(down))
    };
    let weights = [of_pixel(0), of_pixel(1), of_pixel(2), of_pixel(3)];
    if C == 1 {
        // SAFETY: that of this function.
        return [unsafe { of_one_band(rows, four.taps, weights) }; FOUR];
    }
    let mut values = [vdupq_n_s32(0); FOUR];
    let pixels = rows.into_iter().zip(four.taps).zip(weights);
    for (((rows, first), weights), value) in pixels.zip(&mut values) {
        // SAFETY: that of this function.
        *value = unsafe { of_pixel_of_bands::<S, C, N>(rows, first, weights) };
    }
    values
}

/// Returns the values of a pixel's bands.
///
/// # Safety
/// That of [`tabulated`].
#[target_feature(enable = "neon")]
#[inline]
unsafe fn of_pixel_of_bands<S: Sample, const C: usize, const N: usize>(
    rows: &[&[S]; N],
    first: usize,
    (along, down): (&RowWeights, &ColumnWeights),
) -> int32x4_t {
    let along = of_row(along);
    let (low, high) = (vget_low_s16(along), vget_high_s16(along));
    let mut value = vdupq_n_f32(0.0);
    for (number, (row, weight)) in rows.iter().zip(down).enumerate() {
        // SAFETY: that of this function.
        let sum = unsafe {
            let mut sum = vmull_lane_s16::<0>(load_4(row, first), low);
            sum = vmlal_lane_s16::<1>(sum, load_4(row, first + C), low);
            sum = vmlal_lane_s16::<2>(sum, load_4(row, first + 2 * C), low);
            sum = vmlal_lane_s16::<3>(sum, load_4(row, first + 3 * C), low);
            if N > 4 {
                sum = vmlal_lane_s16::<0>(sum, load_4(row, first + 4 * C), high);
                sum = vmlal_lane_s16::<1>(sum, load_4(row, first + 5 * C), high);
            }
            sum
        };
        let product = vmulq_n_f32(vcvtq_f32_s32(sum), *weight);
        value = if number == 0 {
            product
        } else {
            vaddq_f32(value, product)
        };
    }
    vcvtnq_s32_f32(value)
}

/// Returns the values of four pixels of one band.
///
/// # Safety
/// That of [`tabulated`].
#[target_feature(enable = "neon")]
#[inline]
unsafe fn of_one_band<S: Sample, const N: usize>(
    [rows_a, rows_b, rows_c, rows_d]: [&[&[S]; N]; FOUR],
    [first_a, first_b, first_c, first_d]: [usize; FOUR],
    [
        (along_a, down_a),
        (along_b, down_b),
        (along_c, down_c),
        (along_d, down_d),
    ]: [(&RowWeights, &ColumnWeights); FOUR],
) -> int32x4_t {
    let (along_a, along_b) = (of_row(along_a), of_row(along_b));
    let (along_c, along_d) = (of_row(along_c), of_row(along_d));
    let rows = rows_a.iter().zip(rows_b).zip(rows_c.iter().zip(rows_d));
    let down = down_a.iter().zip(down_b).zip(down_c.iter().zip(down_d));
    let mut value = vdupq_n_f32(0.0);
    for (number, (((a, b), (c, d)), ((down_a, down_b), (down_c, down_d)))) in
        rows.zip(down).enumerate()
    {
        // SAFETY: that of this function.
        let (a, b, c, d) = unsafe {
            (
                products::<S, N>(a, first_a, along_a),
                products::<S, N>(b, first_b, along_b),
                products::<S, N>(c, first_c, along_c),
                products::<S, N>(d, first_d, along_d),
            )
        };
        let sums = vpaddq_s32(vpaddq_s32(a, b), vpaddq_s32(c, d));
        let down = [*down_a, *down_b, *down_c, *down_d];
        // SAFETY: four numbers of 32 bits are borrowed.
        let down = unsafe { vld1q_f32(down.as_ptr()) };
        let product = vmulq_f32(vcvtq_f32_s32(sums), down);
        value = if number == 0 {
            product
        } else {
            vaddq_f32(value, product)
        };
    }
    vcvtnq_s32_f32(value)
}

/// Returns the weighted taps of one band along a row, in four sums.
///
/// # Safety
/// That of [`tabulated`].
#[target_feature(enable = "neon")]
#[inline]
unsafe fn products<S: Sample, const N: usize>(
    row: &[S],
    first: usize,
    along: int16x8_t,
) -> int32x4_t {
    if N > 4 {
        // The weights behind the last tap are zero.
        // SAFETY: that of this function.
        let taps = unsafe { load_8(row, first) };
        let low = vmull_s16(vget_low_s16(taps), vget_low_s16(along));
        vmlal_high_s16(low, taps, along)
    } else {
        // SAFETY: that of this function.
        vmull_s16(unsafe { load_4(row, first) }, vget_low_s16(along))
    }
}

/// Loads the weights of a row.
#[target_feature(enable = "neon")]
#[inline]
fn of_row(weights: &RowWeights) -> int16x8_t {
    // SAFETY: eight weights of 16 bits are borrowed.
    unsafe { vld1q_s16(weights.as_ptr()) }
}
