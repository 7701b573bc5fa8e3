//! AVX2: eight lanes of 32 bits, two pixels of three or four bands or eight of one.
//!
//! The taps of a pixel of several bands are loaded beside each other and put in the order of the
//! lanes by a shuffle of bytes; those of one band are gathered in pairs. A multiplication adds the
//! products of each pair.

#![allow(
    clippy::wildcard_imports,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::many_single_char_names,
    reason = "intrinsics; numbers of lanes, taps and bands; rows and pixels in their order"
)]

mod job;
mod lanes;
mod store;
mod tabulated;

use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch, _mm256_setzero_si256};

use pulp::x86::V3;

use super::band::Band;
use super::by_size::by_size;
use super::pixel::{Places, taps_before};
use super::portable::{Row, Vectors};
use super::run::{PLACE_BITS, RUN_PX, Run};
use super::sample::Sample;
use super::weights::Weights;
use job::Job;
use lanes::{LOADED, Lanes};
use store::store;

/// Largest way between two places along a row, 1/2²⁴ px.
const LONGEST_STEP: i32 = 4 << PLACE_BITS;

/// Samples by which the memory that is asked for lies ahead of a run; it need not exist.
const AHEAD: usize = 1024;

/// Resamples a row and returns the number of border pixels.
pub(super) fn row<S: Sample>(_: V3, taps: usize, row: Row<'_, S>) -> u32 {
    // SAFETY: the proof says that the processor has the instructions.
    unsafe { enabled(taps, row) }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn enabled<S: Sample>(taps: usize, row: Row<'_, S>) -> u32 {
    by_size(Avx2(()), taps, row)
}

/// Vectors of a processor that has them: made in [`enabled`] alone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Avx2(());

impl<S: Sample, const C: usize, const N: usize> Vectors<S, C, N> for Avx2 {
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
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
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
    // all. The last pair of taps begins N - 2 pixels behind the first.
    let first = i64::from(base_col.wrapping_sub(before)) * C as i64;
    let last_px = i64::from(places.col.at(RUN_PX as i32 - 1) >> PLACE_BITS);
    let last = first + (last_px + N as i64 - 2) * C as i64;
    if first < 0 || last + LOADED as i64 > source.samples_of_row() as i64 {
        return None;
    }
    let row = places.row.at(0) >> PLACE_BITS;
    let end = places.row.at(out.len() as i32 - 1) >> PLACE_BITS;
    let job = Job {
        weights,
        lanes: [Lanes::new(&places, 0), Lanes::new(&places, 8)],
        places,
        first: first as usize,
    };
    let rows = source.rows::<N>(base_row.wrapping_add(row).wrapping_sub(before))?;
    // Of the rows only the last is new since the output row before.
    if let Some(newest) = rows.last() {
        let ahead = newest.as_ptr().wrapping_add(job.first + AHEAD);
        _mm_prefetch::<_MM_HINT_T0>(ahead.cast());
        _mm_prefetch::<_MM_HINT_T0>(ahead.wrapping_byte_add(64).cast());
    }
    let mut values = [_mm256_setzero_si256(); 8];
    // SAFETY: the loads of all pixels lie within the rows, as was found before.
    unsafe { job.fill::<S, C, N>(rows, &mut values) }?;
    if row != end {
        // SAFETY: as before.
        unsafe { job.across_rows::<S, C, N>(source, run, [row, end], &mut values) }?;
    }
    store::<S, C>(&values, out);
    Some(())
}
