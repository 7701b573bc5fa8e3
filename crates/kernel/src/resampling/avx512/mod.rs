//! AVX-512: sixteen lanes of 32 bits, four pixels of three or four bands, or sixteen of one band;
//! with two taps also of each of three bands.
//!
//! One load and one permutation of 16-bit samples per source row put pairs of taps beside each
//! other, in the order of the lanes; a multiplication adds the products of each pair.

#![allow(
    clippy::wildcard_imports,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::many_single_char_names,
    reason = "intrinsics; numbers of lanes, taps and bands; rows and pixels in their order"
)]

mod bands;
mod group;
mod job;
mod lanes;
mod samples;
mod store;
mod tabulated;

use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch, _mm512_setzero_si512};

use pulp::x86::V4;

use super::band::Band;
use super::by_size::by_size;
use super::pixel::{Places, taps_before};
use super::portable::{Row, Vectors};
use super::run::{PLACE_BITS, RUN_PX, Run};
use super::sample::Sample;
use super::weights::Weights;
use group::{group_px, loaded};
use job::Job;
use lanes::Lanes;
use store::store;

/// Largest way between two places along a row, 1/2²⁴ px: with it, the taps of a group lie within
/// the samples of one load, or of two for four bands and six taps.
const LONGEST_STEP: i32 = 5 << (PLACE_BITS - 2);

/// Samples by which the memory that is asked for lies ahead of a run; it need not exist.
const AHEAD: usize = 1024;

/// Resamples a row and returns the number of border pixels.
pub(super) fn row<S: Sample>(_: V4, taps: usize, row: Row<'_, S>) -> u32 {
    // SAFETY: the proof says that the processor has the instructions.
    unsafe { enabled(taps, row) }
}

#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
fn enabled<S: Sample>(taps: usize, row: Row<'_, S>) -> u32 {
    by_size(Avx512(()), taps, row)
}

/// Vectors of a processor that has them: made in [`enabled`] alone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx512(());

impl<S: Sample, const C: usize, const N: usize> Vectors<S, C, N> for Avx512 {
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
        if (start >> PLACE_BITS) != 0 || !(1..=LONGEST_STEP).contains(&step) {
            return false;
        }
        // SAFETY: `self` is a proof that the processor has the instructions.
        unsafe { pixels::<S, C, N>(source, weights, run, out) }.is_some()
    }
}

/// Writes the pixels of a run; `None` if they have to be computed one by one.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn pixels<S: Sample, const C: usize, const N: usize>(
    source: &Band<'_, S>,
    weights: Option<&Weights>,
    run: &Run,
    out: &mut [[S; C]],
) -> Option<()> {
    let places = Places::new::<N>(run);
    let lanes = Lanes::new::<C, N>(&places);
    let [base_col, base_row] = run.base_px;
    let before = taps_before(N) as i32;
    let first_col = base_col.wrapping_sub(before);
    // Columns do not decrease along a run: what is loaded for the first and for the last group
    // says all.
    let last_px = RUN_PX as i32 - group_px(C, N);
    let first = i64::from(first_col) * C as i64;
    let last = first + i64::from(places.col.at(last_px) >> PLACE_BITS) * C as i64;
    let samples = source.samples_of_row();
    if first < 0 || last + loaded(C, N) as i64 > samples as i64 {
        return None;
    }
    let row = places.row.at(0) >> PLACE_BITS;
    let end = places.row.at(out.len() as i32 - 1) >> PLACE_BITS;
    let job = Job {
        weights,
        places,
        lanes,
        first: first as usize,
    };
    let rows = source.rows::<N>(base_row.wrapping_add(row).wrapping_sub(before))?;
    // Of the rows only the last is new since the output row before.
    if let Some(newest) = rows.last() {
        let ahead = newest.as_ptr().wrapping_add(job.first + AHEAD);
        _mm_prefetch::<_MM_HINT_T0>(ahead.cast());
        _mm_prefetch::<_MM_HINT_T0>(ahead.wrapping_byte_add(64).cast());
    }
    let mut values = [_mm512_setzero_si512(); 4];
    // SAFETY: the loads of all groups lie within the rows, as was found before.
    unsafe { job.fill::<S, C, N>(rows, &mut values) }?;
    if row != end {
        // SAFETY: as before.
        unsafe { job.across_rows::<S, C, N>(source, run, [row, end], &mut values) }?;
    }
    store::<S, C, N>(&values, out);
    Some(())
}
