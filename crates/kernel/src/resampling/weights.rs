//! Weights of the kernels with four and six taps, in tables over the fraction of a pixel.

use alloc::boxed::Box;
use core::f64::consts::PI;

use super::kernel::Kernel;

/// Fractions of a pixel in a table; a place is rounded to the nearest of them.
pub const FRACTIONS: usize = 1 << FRACTION_BITS;
/// Bits of the fraction that select an entry of a table.
pub(super) const FRACTION_BITS: u32 = 12;
/// Distance of fractions.
const STEP: f64 = 1.0 / (1_u32 << FRACTION_BITS) as f64;
/// Sum of the weights of a row: 14 bits.
pub const UNIT: i16 = 1 << UNIT_BITS;
pub(super) const UNIT_BITS: u32 = 14;
/// Largest number of taps of a kernel.
pub const MAX_TAPS: usize = 6;

/// Weights of the taps along a row, in 1/2¹⁴; those beyond the kernel's taps are zero.
pub(super) type RowWeights = [i16; 8];
/// Weights of the taps along a column, divided by 2¹⁴; those beyond the kernel's taps are zero.
pub(super) type ColumnWeights = [f32; 8];

/// Weights of one kernel for every fraction of a pixel, from 0 to 1 - 1/[`FRACTIONS`].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    pub(super) rows: Box<[RowWeights; FRACTIONS]>,
    pub(super) columns: Box<[ColumnWeights; FRACTIONS]>,
}

impl Weights {
    /// Returns the tables of a kernel.
    ///
    /// # Model
    /// The taps lie at the places 1 - n/2 to n/2 about the pixel at or before the fraction t, the
    /// weight of the tap at i is kernel(t - i) over the sum of all. Along rows they are rounded so
    /// that their sum is exact, and for kernels that reproduce a ramp also their first moment.
    #[expect(
        clippy::large_stack_arrays,
        reason = "192 kB at most, once per frame, on their way to the heap"
    )]
    pub(super) fn new(kernel: Kernel) -> Self {
        let mut rows = Box::new([[0; 8]; FRACTIONS]);
        let mut columns = Box::new([[0.0; 8]; FRACTIONS]);
        let mut fraction = 0.0;
        for (row, column) in rows.iter_mut().zip(columns.iter_mut()) {
            let exact = weights(kernel, fraction);
            *row = rounded(kernel, exact, fraction);
            for (weight, exact) in column.iter_mut().zip(exact) {
                *weight = single(exact / f64::from(UNIT));
            }
            fraction += STEP;
        }
        Self { rows, columns }
    }

    /// Returns the weights along a row for a fraction, in 1/[`FRACTIONS`].
    #[inline(always)]
    pub(super) fn along(&self, fraction: usize) -> &RowWeights {
        self.rows.get(fraction & (FRACTIONS - 1)).unwrap_or(&[0; 8])
    }

    /// Returns the weights along a column for a fraction, in 1/[`FRACTIONS`].
    #[inline(always)]
    pub(super) fn down(&self, fraction: usize) -> &ColumnWeights {
        self.columns
            .get(fraction & (FRACTIONS - 1))
            .unwrap_or(&[0.0; 8])
    }
}

#[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
const fn single(number: f64) -> f32 {
    number as f32
}

/// Returns the weights of a kernel's taps for a fraction of a pixel, their sum being 1; those
/// beyond its taps are zero.
///
/// # Units and frames
/// The fraction is that of the way from the tap at place n/2 - 1, counted from 0, to the next one;
/// the nearest pixel has the weight 1 at any fraction.
#[must_use]
pub fn weights(kernel: Kernel, fraction: f64) -> [f64; MAX_TAPS] {
    let mut weights = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let taps = kernel.taps();
    if taps == 1 {
        return weights;
    }
    let mut place = 1.0 - f64::from(kernel.half_taps());
    let mut sum = 0.0;
    for weight in weights.iter_mut().take(taps) {
        *weight = value(kernel, fraction - place);
        sum += *weight;
        place += 1.0;
    }
    weights.map(|weight| weight / sum)
}

/// Returns the kernel at a distance of x pixels.
fn value(kernel: Kernel, x: f64) -> f64 {
    let x = libm::fabs(x);
    match kernel {
        Kernel::Nearest => 1.0,
        Kernel::Bilinear => (1.0 - x).max(0.0),
        // Keys 1981, eq. 15: a = -1/2.
        Kernel::Bicubic if x < 1.0 => (1.5 * x - 2.5) * x * x + 1.0,
        Kernel::Bicubic if x < 2.0 => ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0,
        // Keys 1981, eq. 25: six points, fourth order.
        Kernel::Keys6 if x < 1.0 => (4.0 / 3.0 * x - 7.0 / 3.0) * x * x + 1.0,
        Kernel::Keys6 if x < 2.0 => ((-7.0 / 12.0 * x + 3.0) * x - 59.0 / 12.0) * x + 2.5,
        Kernel::Keys6 if x < 3.0 => ((x / 12.0 - 2.0 / 3.0) * x + 1.75) * x - 1.5,
        Kernel::Lanczos3 if x < 1e-9 => 1.0,
        Kernel::Lanczos3 if x < 3.0 => {
            3.0 * libm::sin(PI * x) * libm::sin(PI * x / 3.0) / (PI * PI * x * x)
        }
        Kernel::Bicubic | Kernel::Keys6 | Kernel::Lanczos3 => 0.0,
    }
}

/// Rounds weights to 1/2¹⁴ so that their sum is exact and, if the kernel reproduces a ramp, their
/// first moment: the two taps in the middle take what the others, each rounded down or up, leave.
/// Of all such weights those with the least sum of squared roundings are taken.
fn rounded(kernel: Kernel, exact: [f64; MAX_TAPS], fraction: f64) -> RowWeights {
    let taps = kernel.taps();
    let before = taps / 2 - 1;
    let exact = exact.map(|weight| weight * f64::from(UNIT));
    let at_after = exact.get(before + 1).copied().unwrap_or_default();
    let mut best = (f64::INFINITY, exact);
    for choice in 0..1_u32 << (taps - 2) {
        let mut candidate = exact;
        let (mut sum, mut moment, mut choices) = (0.0, 0.0, choice);
        let mut place = 1.0 - f64::from(kernel.half_taps());
        for (index, weight) in candidate.iter_mut().enumerate().take(taps) {
            if index != before && index != before + 1 {
                *weight = libm::floor(*weight) + f64::from(choices & 1);
                choices >>= 1;
                sum += *weight;
                moment += place * *weight;
            }
            place += 1.0;
        }
        let after = if kernel.reproduces_ramp() {
            // FRACTIONS divides the unit.
            libm::round(fraction * f64::from(UNIT)) - moment
        } else {
            libm::round(at_after)
        };
        let middle = [f64::from(UNIT) - sum - after, after];
        for (weight, value) in candidate.iter_mut().skip(before).zip(middle) {
            *weight = value;
        }
        let squares = candidate.iter().zip(exact);
        let squares = squares.map(|(a, b)| (a - b) * (a - b)).sum();
        if squares < best.0 {
            best = (squares, candidate);
        }
    }
    let mut row = [0; 8];
    for (weight, rounded) in row.iter_mut().zip(best.1) {
        *weight = whole(rounded);
    }
    row
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a whole number of at most 2¹⁴"
)]
const fn whole(number: f64) -> i16 {
    number as i16
}
