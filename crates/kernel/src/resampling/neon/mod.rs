//! NEON: four lanes of 32 bits, a pixel of three or four bands or four pixels of one.
//!
//! Every tap of several bands is loaded by itself and multiplied by its weight, which is a lane of
//! the weights of its row; those of one band are multiplied beside each other, and neighbouring
//! lanes added.

#![allow(
    clippy::wildcard_imports,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::many_single_char_names,
    reason = "intrinsics; numbers of lanes, taps and bands; rows and pixels in their order"
)]

mod bilinear;
mod four;
mod samples;
mod tabulated;

use pulp::aarch64::Neon;

use super::band::Band;
use super::by_size::by_size;
use super::pixel::{Places, taps_before};
use super::portable::{Row, Vectors};
use super::run::{PLACE_BITS, RUN_PX, Run};
use super::sample::Sample;
use super::weights::Weights;
use bilinear::bilinear;
use four::{FOUR, Four};
use samples::{loaded, store};
use tabulated::tabulated;

/// Largest way between two places along a row, 1/2²⁴ px.
const LONGEST_STEP: i32 = 4 << PLACE_BITS;

/// Resamples a row and returns the number of border pixels.
pub(super) fn row<S: Sample>(_: Neon, taps: usize, row: Row<'_, S>) -> u32 {
    // SAFETY: the proof says that the processor has the instructions.
    unsafe { enabled(taps, row) }
}

#[target_feature(enable = "neon")]
fn enabled<S: Sample>(taps: usize, row: Row<'_, S>) -> u32 {
    by_size(OfNeon(()), taps, row)
}

/// Vectors of a processor that has them: made in [`enabled`] alone.
#[derive(Debug, Clone, Copy)]
struct OfNeon(());

impl<S: Sample, const C: usize, const N: usize> Vectors<S, C, N> for OfNeon {
    #[inline(always)]
    fn run(
        self,
        source: &Band<'_, S>,
        weights: Option<&Weights>,
        run: &Run,
        out: &mut [[S; C]],
    ) -> bool {
        let [start, _] = run.start;
        let [step, _] = run.step;
        if N == 1 || (start >> PLACE_BITS) != 0 || !(1..=LONGEST_STEP).contains(&step) {
            return false;
        }
        // SAFETY: `self` is a proof that the processor has the instructions.
        unsafe { pixels::<S, C, N>(source, weights, run, out) }.is_some()
    }
}

/// Writes the pixels of a run; `None` if they have to be computed one by one.
#[target_feature(enable = "neon")]
#[inline]
fn pixels<S: Sample, const C: usize, const N: usize>(
    source: &Band<'_, S>,
    weights: Option<&Weights>,
    run: &Run,
    out: &mut [[S; C]],
) -> Option<()> {
    let places = Places::new::<N>(run);
    let [base_col, base_row] = run.base_px;
    let before = taps_before(N) as i32;
    // Columns do not decrease along a run: what is loaded for the first and for the last pixel says
    // all.
    let first = i64::from(base_col.wrapping_sub(before)) * C as i64;
    let last_px = i64::from(places.col.at(RUN_PX as i32 - 1) >> PLACE_BITS);
    let last = first + last_px * C as i64;
    if first < 0 || last + loaded(C, N) as i64 > source.samples_of_row() as i64 {
        return None;
    }
    let row_of = |pixel: i32| places.row.at(pixel) >> PLACE_BITS;
    let rows_of = |row: i32| source.rows::<N>(base_row.wrapping_add(row).wrapping_sub(before));
    let (row, end_px) = (row_of(0), out.len() as i32 - 1);
    let (rows, is_one_row) = (rows_of(row)?, row == row_of(end_px));
    let mut pixel = 0;
    for pixels in out.chunks_mut(FOUR) {
        let of_four = if is_one_row {
            [rows; FOUR]
        } else {
            // Pixels behind the last have its rows, which are in memory.
            let of = |number: i32| rows_of(row_of((pixel + number).min(end_px)));
            [of(0)?, of(1)?, of(2)?, of(3)?]
        };
        let four = Four::new::<C>(places, pixel, first as usize);
        // SAFETY: the loads of all pixels lie within the rows, as was found before.
        let values = unsafe {
            if N == 2 {
                bilinear::<S, C, N>(&four, of_four)
            } else {
                tabulated::<S, C, N>(&four, of_four, weights?)
            }
        };
        store(&values, pixels);
        pixel += FOUR as i32;
    }
    Some(())
}
