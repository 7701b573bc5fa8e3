//! One pixel from its taps: the arithmetic that every instruction set performs.

use super::run::{PLACE_BITS, Run};
use super::sample::Sample;
use super::weights::{FRACTION_BITS, UNIT, UNIT_BITS, Weights};

/// 1.5·2²³: added to a number below 2²² in size, it leaves the number rounded to even in the last
/// bits.
const ROUNDING: f32 = 12_582_912.0;

/// Bits of the fraction that a kernel of `taps` taps uses.
pub(super) const fn fraction_bits(taps: usize) -> u32 {
    match taps {
        1 => 0,
        2 => UNIT_BITS,
        _ => FRACTION_BITS,
    }
}

/// Half a unit of the fraction that a kernel uses, 1/2²⁴ px.
pub(super) const fn half_unit(taps: usize) -> i32 {
    1 << (PLACE_BITS - fraction_bits(taps) - 1)
}

/// Taps before the pixel at or before a place.
pub(super) const fn taps_before(taps: usize) -> usize {
    (taps - 1) / 2
}

/// Places of a run from its base, rounded to the fraction of a kernel, for vectors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) col: Axis,
    pub(super) row: Axis,
}

/// Places along an axis, 1/2²⁴ px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    pub(super) start: i32,
    pub(super) step: i32,
}

impl Places {
    /// Returns the places for a kernel of N taps.
    #[inline(always)]
    pub(super) fn new<const N: usize>(run: &Run) -> Self {
        let ([col, row], [col_step, row_step]) = (run.start, run.step);
        let axis = |start: i32, step: i32| Axis {
            start: start.wrapping_add(half_unit(N)),
            step,
        };
        Self {
            col: axis(col, col_step),
            row: axis(row, row_step),
        }
    }
}

impl Axis {
    /// Returns the place of a pixel.
    #[inline(always)]
    pub(super) const fn at(&self, pixel: i32) -> i32 {
        self.start.wrapping_add(self.step.wrapping_mul(pixel))
    }

    /// Returns the fraction of a pixel's place, in units of a kernel of N taps.
    #[expect(clippy::cast_sign_loss, reason = "the bits of a fraction have no sign")]
    #[inline(always)]
    pub(super) const fn fraction<const N: usize>(&self, pixel: i32) -> usize {
        let bits = fraction_bits(N);
        (self.at(pixel) >> (PLACE_BITS - bits)) as usize & ((1 << bits) - 1)
    }
}

/// Splits a place, 1/2²⁴ px, into the pixel at or before it and the fraction from there on, in
/// units of the kernel.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most 14 bits are left, none of them a sign"
)]
#[inline(always)]
pub(super) fn split<const N: usize>(place: i64) -> (i64, usize) {
    let rounded = place + i64::from(half_unit(N));
    let fraction = rounded >> (PLACE_BITS - fraction_bits(N)) & ((1 << fraction_bits(N)) - 1);
    (rounded >> PLACE_BITS, fraction as usize)
}

/// Returns the samples of a pixel from N rows of N taps.
#[inline(always)]
pub(super) fn blend<S: Sample, const C: usize, const N: usize>(
    taps: [&[[S; C]; N]; N],
    fraction: [usize; 2],
    weights: Option<&Weights>,
) -> [S; C] {
    match N {
        1 => taps
            .first()
            .map_or([S::default(); C], |row| first(row.as_slice())),
        2 => bilinear(taps, fraction),
        _ => weights.map_or([S::default(); C], |weights| {
            tabulated(taps, fraction, weights)
        }),
    }
}

#[inline(always)]
fn first<S: Sample, const C: usize>(taps: &[[S; C]]) -> [S; C] {
    taps.first().copied().unwrap_or([S::default(); C])
}

/// Returns the weights of two rows of two taps, in 1/2¹⁴: products of the fractions of which one is
/// rounded, the others being what its row and column leave.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "fractions of 14 bits"
)]
#[inline(always)]
pub(super) const fn bilinear_weights([col, row]: [usize; 2]) -> [[i32; 2]; 2] {
    let (col, row) = (col as i32, row as i32);
    let both = (col * row + (1 << (UNIT_BITS - 1))) >> UNIT_BITS;
    [
        [UNIT as i32 - col - row + both, col - both],
        [row - both, both],
    ]
}

#[inline(always)]
fn bilinear<S: Sample, const C: usize, const N: usize>(
    taps: [&[[S; C]; N]; N],
    fraction: [usize; 2],
) -> [S; C] {
    let weights = bilinear_weights(fraction);
    let mut sums = [1 << (UNIT_BITS - 1); C];
    for (row, weights) in taps.into_iter().zip(weights) {
        for (tap, weight) in row.iter().zip(weights) {
            for (sum, sample) in sums.iter_mut().zip(tap) {
                *sum += weight * sample.centred();
            }
        }
    }
    sums.map(|sum| S::saturated(sum >> UNIT_BITS))
}

#[inline(always)]
fn tabulated<S: Sample, const C: usize, const N: usize>(
    taps: [&[[S; C]; N]; N],
    [col, row]: [usize; 2],
    weights: &Weights,
) -> [S; C] {
    let (along, down) = (*weights.along(col), *weights.down(row));
    let mut values = [0.0; C];
    for (number, (row, weight)) in taps.into_iter().zip(down).enumerate() {
        let mut sums = [0; C];
        for (tap, weight) in row.iter().zip(along) {
            for (sum, sample) in sums.iter_mut().zip(tap) {
                *sum += i32::from(weight) * sample.centred();
            }
        }
        for (value, sum) in values.iter_mut().zip(sums) {
            let product = single(sum) * weight;
            // Zero plus a product is not the product where that is a negative zero, but it is once
            // rounded.
            *value = if number == 0 {
                product
            } else {
                *value + product
            };
        }
    }
    values.map(|value| S::saturated(nearest(value)))
}

/// Returns the nearest number in single precision, ties to even.
#[expect(clippy::cast_precision_loss, reason = "that is the rounding")]
#[inline(always)]
const fn single(sum: i32) -> f32 {
    sum as f32
}

/// Returns the nearest whole number, ties to even, of one below 2²² in size.
#[expect(clippy::cast_possible_wrap, reason = "bits of positive numbers")]
#[inline(always)]
fn nearest(value: f32) -> i32 {
    (value + ROUNDING).to_bits() as i32 - ROUNDING.to_bits() as i32
}
