//! AVX-512: sixteen lanes of 32 bits, four pixels of three or four bands or sixteen of one.
//!
//! One load and one permutation of 16-bit samples per source row put pairs of taps beside each
//! other, in the order of the lanes; a multiplication adds the products of each pair.

#![expect(
    clippy::wildcard_imports,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "intrinsics, and numbers of lanes, taps and bands"
)]

use core::arch::x86_64::*;

use pulp::x86::V4;

use super::band::Band;
use super::dispatch::by_size;
use super::pixel::{Places, taps_before};
use super::portable::{Row, Vectors};
use super::run::{PLACE_BITS, RUN_PX, Run};
use super::sample::Sample;
use super::weights::{
    ColumnWeights, FRACTION_BITS, FRACTIONS, RowWeights, UNIT, UNIT_BITS, Weights,
};

/// Largest way between two places along a row, 1/2²⁴ px: with it, the taps of a group lie within
/// the samples of one load, or of two for four bands and six taps.
const LONGEST_STEP: i32 = 5 << (PLACE_BITS - 2);

/// Samples by which the memory that is asked for lies ahead of a run; it need not exist.
const AHEAD: usize = 1024;

/// Samples of a load.
const LOADED: usize = 32;

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

/// Pixels of a group.
const fn group_px(bands: usize) -> i32 {
    if bands == 1 { 16 } else { 4 }
}

/// Samples from a group's first tap on that are loaded.
const fn loaded(bands: usize, taps: usize) -> usize {
    let wide = bands > 1 && bands * (4 + taps) > LOADED;
    if wide { 2 * LOADED } else { LOADED }
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
    let last_px = RUN_PX as i32 - group_px(C);
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
    store::<S, C>(&values, out);
    Some(())
}

/// Places of the sixteen pixels of a run.
struct Lanes {
    /// Fractions of the bilinear kernel, or bits of which they are taken.
    col: __m512i,
    row: __m512i,
    /// Row from the base.
    whole_row: __m512i,
    /// First tap from that of the group's first pixel, in samples, in both halves of a lane.
    samples: __m512i,
}

impl Lanes {
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn new<const C: usize, const N: usize>(places: &Places) -> Self {
        let numbers = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let col_way = _mm512_mullo_epi32(numbers, _mm512_set1_epi32(places.col.step));
        let row_way = _mm512_mullo_epi32(numbers, _mm512_set1_epi32(places.row.step));
        let col = _mm512_add_epi32(_mm512_set1_epi32(places.col.start), col_way);
        let row = _mm512_add_epi32(_mm512_set1_epi32(places.row.start), row_way);
        let cols = _mm512_srai_epi32::<PLACE_BITS>(col);
        let samples = match C {
            1 => cols,
            3 => _mm512_add_epi32(cols, _mm512_add_epi32(cols, cols)),
            _ => _mm512_slli_epi32::<2>(cols),
        };
        let both = _mm512_or_si512(samples, _mm512_slli_epi32::<16>(samples));
        let firsts = if C == 1 {
            _mm512_setzero_si512()
        } else {
            _mm512_setr_epi32(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12)
        };
        let samples = _mm512_sub_epi16(both, _mm512_permutexvar_epi32(firsts, both));
        Self {
            col,
            row,
            whole_row: _mm512_srai_epi32::<PLACE_BITS>(row),
            samples,
        }
    }
}

/// A run with its weights.
struct Job<'a> {
    weights: Option<&'a Weights>,
    places: Places,
    lanes: Lanes,
    /// Sample of a row from which the columns of the places are counted.
    first: usize,
}

impl Job<'_> {
    /// Computes the values of a run from N source rows.
    ///
    /// # Safety
    /// From the first tap of every group on, [`loaded`] samples lie within each row.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn fill<S: Sample, const C: usize, const N: usize>(
        &self,
        rows: &[&[S]; N],
        [first, second, third, fourth]: &mut [__m512i; 4],
    ) -> Option<()> {
        // SAFETY: that of this function.
        unsafe {
            if N == 1 {
                *first = self.nearest::<S, C, 0>(rows.as_slice());
                if C > 1 {
                    *second = self.nearest::<S, C, 1>(rows.as_slice());
                    *third = self.nearest::<S, C, 2>(rows.as_slice());
                    *fourth = self.nearest::<S, C, 3>(rows.as_slice());
                }
            } else if N == 2 {
                let pairs = self.bilinear_pairs();
                *first = self.bilinear::<S, C, 0>(rows.as_slice(), &pairs);
                if C > 1 {
                    *second = self.bilinear::<S, C, 1>(rows.as_slice(), &pairs);
                    *third = self.bilinear::<S, C, 2>(rows.as_slice(), &pairs);
                    *fourth = self.bilinear::<S, C, 3>(rows.as_slice(), &pairs);
                }
            } else if C == 1 {
                let weights = Tabulated::of_lanes::<N>(self.weights?, &self.lanes);
                *first = self.tabulated::<S, C, N, 0>(rows, &weights);
            } else {
                let (weights, places) = (self.weights?, &self.places);
                let of_group = Tabulated::of_group::<N>(weights, places, 0);
                *first = self.tabulated::<S, C, N, 0>(rows, &of_group);
                let of_group = Tabulated::of_group::<N>(weights, places, 1);
                *second = self.tabulated::<S, C, N, 1>(rows, &of_group);
                let of_group = Tabulated::of_group::<N>(weights, places, 2);
                *third = self.tabulated::<S, C, N, 2>(rows, &of_group);
                let of_group = Tabulated::of_group::<N>(weights, places, 3);
                *fourth = self.tabulated::<S, C, N, 3>(rows, &of_group);
            }
        }
        Some(())
    }

    /// Replaces the values of pixels that lie in other rows than the first.
    ///
    /// # Safety
    /// That of [`Self::fill`], for all rows of the source that are in memory.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline(never)]
    unsafe fn across_rows<S: Sample, const C: usize, const N: usize>(
        &self,
        source: &Band<'_, S>,
        run: &Run,
        [first, last]: [i32; 2],
        values: &mut [__m512i; 4],
    ) -> Option<()> {
        let [_, base_row] = run.base_px;
        let row_of = self.lanes.whole_row;
        let row_of = [
            Self::spread::<C, 0>(row_of),
            Self::spread::<C, 1>(row_of),
            Self::spread::<C, 2>(row_of),
            Self::spread::<C, 3>(row_of),
        ];
        for row in first.min(last)..=first.max(last) {
            if row == first {
                continue;
            }
            let before = taps_before(N) as i32;
            let rows = source.rows::<N>(base_row.wrapping_add(row).wrapping_sub(before))?;
            let mut of_row = [_mm512_setzero_si512(); 4];
            // SAFETY: that of this function.
            unsafe { self.fill::<S, C, N>(rows, &mut of_row) }?;
            let row = _mm512_set1_epi32(row);
            for ((value, of_row), rows) in values.iter_mut().zip(of_row).zip(row_of) {
                let here = _mm512_cmpeq_epi32_mask(rows, row);
                *value = _mm512_mask_mov_epi32(*value, here, of_row);
            }
        }
        Some(())
    }

    /// Returns the lanes of a group from one lane per pixel.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn spread<const C: usize, const G: i32>(of_pixels: __m512i) -> __m512i {
        if C == 1 {
            return of_pixels;
        }
        let fours = _mm512_setr_epi32(
            4 * G,
            4 * G,
            4 * G,
            4 * G,
            4 * G + 1,
            4 * G + 1,
            4 * G + 1,
            4 * G + 1,
            4 * G + 2,
            4 * G + 2,
            4 * G + 2,
            4 * G + 2,
            4 * G + 3,
            4 * G + 3,
            4 * G + 3,
            4 * G + 3,
        );
        _mm512_permutexvar_epi32(fours, of_pixels)
    }

    /// Returns the first sample that is loaded for a group.
    #[inline(always)]
    fn first<const C: usize, const G: i32>(&self) -> usize {
        self.first + (self.places.col.at(4 * G) >> PLACE_BITS) as usize * C
    }

    /// Returns the places of the first two taps of a group's lanes among the loaded samples.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn taps<const C: usize, const G: i32>(&self) -> __m512i {
        let bands = (C as i32) << 16;
        let of_bands = if C == 1 {
            _mm512_set1_epi32(bands)
        } else {
            _mm512_broadcast_i32x4(_mm_setr_epi32(
                bands,
                bands + 0x1_0001,
                bands + 0x2_0002,
                bands + 0x3_0003,
            ))
        };
        _mm512_add_epi16(Self::spread::<C, G>(self.lanes.samples), of_bands)
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn nearest<S: Sample, const C: usize, const G: i32>(&self, rows: &[&[S]]) -> __m512i {
        let [row, ..] = rows else {
            return _mm512_setzero_si512();
        };
        // SAFETY: that of this function.
        let samples = unsafe { load(row, self.first::<C, G>()) };
        let found = centred::<S>(_mm512_permutexvar_epi16(self.taps::<C, G>(), samples));
        _mm512_srai_epi32::<16>(_mm512_slli_epi32::<16>(found))
    }

    /// Returns the weights of the upper and the lower pair of taps of every pixel.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn bilinear_pairs(&self) -> [__m512i; 2] {
        let unit_less_one = _mm512_set1_epi32((1 << UNIT_BITS) - 1);
        let col = _mm512_srai_epi32::<{ PLACE_BITS - UNIT_BITS }>(self.lanes.col);
        let row = _mm512_srai_epi32::<{ PLACE_BITS - UNIT_BITS }>(self.lanes.row);
        let col = _mm512_and_si512(col, unit_less_one);
        let row = _mm512_and_si512(row, unit_less_one);
        let half = _mm512_set1_epi32(1 << (UNIT_BITS - 1));
        let product = _mm512_add_epi32(_mm512_madd_epi16(col, row), half);
        let both = _mm512_srai_epi32::<UNIT_BITS>(product);
        let unit = _mm512_set1_epi32(UNIT as i32);
        let (after, below) = (_mm512_sub_epi32(col, both), _mm512_sub_epi32(row, both));
        let here = _mm512_sub_epi32(_mm512_sub_epi32(unit, col), below);
        [
            _mm512_or_si512(here, _mm512_slli_epi32::<16>(after)),
            _mm512_or_si512(below, _mm512_slli_epi32::<16>(both)),
        ]
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn bilinear<S: Sample, const C: usize, const G: i32>(
        &self,
        rows: &[&[S]],
        [upper, lower]: &[__m512i; 2],
    ) -> __m512i {
        let [above, below, ..] = rows else {
            return _mm512_setzero_si512();
        };
        let (first, taps) = (self.first::<C, G>(), self.taps::<C, G>());
        // SAFETY: that of this function.
        let (above, below) = unsafe { (load(above, first), load(below, first)) };
        // A compiler that moves this before the permutation permutes the constant, too.
        let above = centred::<S>(_mm512_permutexvar_epi16(taps, above));
        let below = centred::<S>(_mm512_permutexvar_epi16(taps, below));
        let above = _mm512_madd_epi16(above, Self::spread::<C, G>(*upper));
        let below = _mm512_madd_epi16(below, Self::spread::<C, G>(*lower));
        let half = _mm512_set1_epi32(1 << (UNIT_BITS - 1));
        let sum = _mm512_add_epi32(_mm512_add_epi32(above, half), below);
        _mm512_srai_epi32::<UNIT_BITS>(sum)
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn tabulated<S: Sample, const C: usize, const N: usize, const G: i32>(
        &self,
        rows: &[&[S]; N],
        weights: &Tabulated,
    ) -> __m512i {
        let (first, taps) = (self.first::<C, G>(), self.taps::<C, G>());
        let next = _mm512_set1_epi16(2 * C as i16);
        let second = _mm512_add_epi16(taps, next);
        let taps = [taps, second, _mm512_add_epi16(second, next)];
        let [a, b, c, d, rest @ ..] = rows.as_slice() else {
            return _mm512_setzero_si512();
        };
        let [of_a, of_b, of_c, of_d, of_e, of_f] = weights.rows;
        let pairs = &weights.pairs;
        // SAFETY: that of this function.
        unsafe {
            let a = _mm512_mul_ps(sum::<S, C, N>(a, first, &taps, pairs), of_a);
            let b = _mm512_mul_ps(sum::<S, C, N>(b, first, &taps, pairs), of_b);
            let c = _mm512_mul_ps(sum::<S, C, N>(c, first, &taps, pairs), of_c);
            let d = _mm512_mul_ps(sum::<S, C, N>(d, first, &taps, pairs), of_d);
            let mut values = _mm512_add_ps(_mm512_add_ps(_mm512_add_ps(a, b), c), d);
            if let [e, f] = rest {
                let e = _mm512_mul_ps(sum::<S, C, N>(e, first, &taps, pairs), of_e);
                let f = _mm512_mul_ps(sum::<S, C, N>(f, first, &taps, pairs), of_f);
                values = _mm512_add_ps(_mm512_add_ps(values, e), f);
            }
            _mm512_cvtps_epi32(values)
        }
    }
}

/// Returns the weighted sums of taps along a row.
///
/// # Safety
/// From the first on, [`loaded`] samples lie within the row.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
unsafe fn sum<S: Sample, const C: usize, const N: usize>(
    row: &[S],
    first: usize,
    [one, two, three]: &[__m512i; 3],
    weights: &[__m512i; 3],
) -> __m512 {
    // SAFETY: that of this function.
    let low = centred::<S>(unsafe { load(row, first) });
    let high = if loaded(C, N) > LOADED {
        // SAFETY: as above.
        centred::<S>(unsafe { load(row, first + LOADED) })
    } else {
        low
    };
    let [of_one, of_two, of_three] = *weights;
    let one = _mm512_madd_epi16(picked::<C, N>(low, high, *one), of_one);
    let two = _mm512_madd_epi16(picked::<C, N>(low, high, *two), of_two);
    let mut sum = _mm512_add_epi32(one, two);
    if N > 4 {
        let three = _mm512_madd_epi16(picked::<C, N>(low, high, *three), of_three);
        sum = _mm512_add_epi32(sum, three);
    }
    _mm512_cvtepi32_ps(sum)
}

/// Returns samples of one load, or of two.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn picked<const C: usize, const N: usize>(low: __m512i, high: __m512i, taps: __m512i) -> __m512i {
    if loaded(C, N) > LOADED {
        _mm512_permutex2var_epi16(low, taps, high)
    } else {
        _mm512_permutexvar_epi16(taps, low)
    }
}

/// Weights from tables: of pairs of taps along rows, and of rows.
struct Tabulated {
    pairs: [__m512i; 3],
    rows: [__m512; 6],
}

impl Tabulated {
    /// Returns the weights of the four pixels of a group, four lanes each.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn of_group<const N: usize>(weights: &Weights, places: &Places, group: i32) -> Self {
        let [a, b, c, d] = [4 * group, 4 * group + 1, 4 * group + 2, 4 * group + 3];
        let along = |pixel: i32| weights.along(places.col.fraction::<N>(pixel));
        let pairs = _mm512_castsi128_si512(whole(along(a)));
        let pairs = _mm512_inserti32x4::<1>(pairs, whole(along(b)));
        let pairs = _mm512_inserti32x4::<2>(pairs, whole(along(c)));
        let pairs = _mm512_inserti32x4::<3>(pairs, whole(along(d)));
        let down = |pixel: i32| weights.down(places.row.fraction::<N>(pixel));
        let [a, b, c, d] = [down(a), down(b), down(c), down(d)];
        let low = _mm512_castps128_ps512(half(a, 0));
        let low = _mm512_insertf32x4::<1>(low, half(b, 0));
        let low = _mm512_insertf32x4::<2>(low, half(c, 0));
        let low = _mm512_insertf32x4::<3>(low, half(d, 0));
        let mut high = low;
        if N > 4 {
            high = _mm512_castps128_ps512(half(a, 1));
            high = _mm512_insertf32x4::<1>(high, half(b, 1));
            high = _mm512_insertf32x4::<2>(high, half(c, 1));
            high = _mm512_insertf32x4::<3>(high, half(d, 1));
        }
        Self {
            pairs: [
                _mm512_shuffle_epi32::<0b00_00_00_00>(pairs),
                _mm512_shuffle_epi32::<0b01_01_01_01>(pairs),
                _mm512_shuffle_epi32::<0b10_10_10_10>(pairs),
            ],
            rows: [
                _mm512_permute_ps::<0b00_00_00_00>(low),
                _mm512_permute_ps::<0b01_01_01_01>(low),
                _mm512_permute_ps::<0b10_10_10_10>(low),
                _mm512_permute_ps::<0b11_11_11_11>(low),
                _mm512_permute_ps::<0b00_00_00_00>(high),
                _mm512_permute_ps::<0b01_01_01_01>(high),
            ],
        }
    }

    /// Returns the weights of sixteen pixels of one band, a lane each.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn of_lanes<const N: usize>(weights: &Weights, lanes: &Lanes) -> Self {
        let last = _mm512_set1_epi32(FRACTIONS as i32 - 1);
        let col = _mm512_srai_epi32::<{ PLACE_BITS - FRACTION_BITS }>(lanes.col);
        let row = _mm512_srai_epi32::<{ PLACE_BITS - FRACTION_BITS }>(lanes.row);
        // Numbers of 32 bits: 4 to an entry of the one table, 8 to one of the other.
        let col = _mm512_slli_epi32::<2>(_mm512_and_si512(col, last));
        let row = _mm512_slli_epi32::<3>(_mm512_and_si512(row, last));
        let mut pairs = [_mm512_setzero_si512(); 3];
        for (number, pair) in pairs.iter_mut().enumerate().take(N / 2) {
            let index = _mm512_add_epi32(col, _mm512_set1_epi32(number as i32));
            // SAFETY: the index of an entry is less than FRACTIONS, that in the entry less than 4.
            *pair = unsafe { _mm512_i32gather_epi32::<4>(index, weights.rows.as_ptr().cast()) };
        }
        let mut rows = [_mm512_setzero_ps(); 6];
        for (number, weight) in rows.iter_mut().enumerate().take(N) {
            let index = _mm512_add_epi32(row, _mm512_set1_epi32(number as i32));
            // SAFETY: the index of an entry is less than FRACTIONS, that in the entry less than 8.
            *weight = unsafe { _mm512_i32gather_ps::<4>(index, weights.columns.as_ptr().cast()) };
        }
        Self { pairs, rows }
    }
}

/// Subtracts 2¹⁵ from samples of 16 bits.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn centred<S: Sample>(samples: __m512i) -> __m512i {
    if S::BITS == 8 {
        samples
    } else {
        _mm512_xor_si512(samples, _mm512_set1_epi16(i16::MIN))
    }
}

/// Loads samples as numbers of 16 bits.
///
/// # Safety
/// From the first on, [`LOADED`] samples lie within the row.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
unsafe fn load<S: Sample>(row: &[S], first: usize) -> __m512i {
    debug_assert!(first + LOADED <= row.len(), "{first} of {}", row.len());
    // SAFETY: the first sample lies within the row.
    let place = unsafe { row.as_ptr().add(first) };
    if S::BITS == 8 {
        // SAFETY: 32 samples of 8 bits lie within the row.
        _mm512_cvtepu8_epi16(unsafe { _mm256_loadu_si256(place.cast()) })
    } else {
        // SAFETY: 32 samples of 16 bits lie within the row.
        unsafe { _mm512_loadu_si512(place.cast()) }
    }
}

/// Loads the weights of a row.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn whole(weights: &RowWeights) -> __m128i {
    // SAFETY: eight weights of 16 bits are borrowed.
    unsafe { _mm_loadu_si128(weights.as_ptr().cast()) }
}

/// Loads the first or the last four weights of a column.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn half(weights: &ColumnWeights, number: usize) -> __m128 {
    let halves = weights.as_chunks::<4>().0;
    let four = halves.get(number & 1).unwrap_or(&[0.0; 4]);
    // SAFETY: four weights of 32 bits are borrowed.
    unsafe { _mm_loadu_ps(four.as_ptr()) }
}

/// Writes sixteen pixels, or fewer, from four groups.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn store<S: Sample, const C: usize>(groups: &[__m512i; 4], out: &mut [[S; C]]) {
    if let Some(pixels) = out.first_chunk_mut::<16>() {
        if S::BITS == 8 {
            store_bytes(bytes::<C>(groups), pixels);
        } else {
            store_words(words::<C>(groups), pixels);
        }
        return;
    }
    store_few(groups, out);
}

/// Writes fewer than sixteen pixels.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline(never)]
fn store_few<S: Sample, const C: usize>(groups: &[__m512i; 4], out: &mut [[S; C]]) {
    let mut all = [[S::default(); C]; 16];
    if S::BITS == 8 {
        store_bytes(bytes::<C>(groups), &mut all);
    } else {
        store_words(words::<C>(groups), &mut all);
    }
    for (to, from) in out.iter_mut().zip(all) {
        *to = from;
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn store_bytes<S: Sample, const C: usize>(bytes: __m512i, pixels: &mut [[S; C]; 16]) {
    let place = pixels.as_flattened_mut().as_mut_ptr();
    // SAFETY: 16, 48 or 64 samples of 8 bits are borrowed.
    unsafe {
        match C {
            1 => _mm_storeu_si128(place.cast(), _mm512_castsi512_si128(bytes)),
            3 => {
                let high = _mm512_extracti32x4_epi32::<2>(bytes);
                _mm256_storeu_si256(place.cast(), _mm512_castsi512_si256(bytes));
                _mm_storeu_si128(place.add(32).cast(), high);
            }
            _ => _mm512_storeu_si512(place.cast(), bytes),
        }
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn store_words<S: Sample, const C: usize>([low, high]: [__m512i; 2], pixels: &mut [[S; C]; 16]) {
    let place = pixels.as_flattened_mut().as_mut_ptr();
    // SAFETY: 16, 48 or 64 samples of 16 bits are borrowed.
    unsafe {
        match C {
            1 => _mm256_storeu_si256(place.cast(), _mm512_castsi512_si256(low)),
            3 => {
                _mm512_storeu_si512(place.cast(), low);
                _mm256_storeu_si256(place.add(32).cast(), _mm512_castsi512_si256(high));
            }
            _ => {
                _mm512_storeu_si512(place.cast(), low);
                _mm512_storeu_si512(place.add(32).cast(), high);
            }
        }
    }
}

/// Returns sixteen pixels of 16 bits, one behind the other.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn words<const C: usize>(&[a, b, c, d]: &[__m512i; 4]) -> [__m512i; 2] {
    /// Samples of the output among those of two vectors, each of which has pixels of the one
    /// group and of the next in turn.
    const PLACES: [[i16; 32]; 2] = {
        let mut places = [[0; 32]; 2];
        let mut sample = 0;
        while sample < 48 {
            let (pixel, band) = (sample / 3, sample % 3);
            let (group, number) = (pixel / 4, pixel % 4);
            let place = group / 2 * 32 + number * 8 + group % 2 * 4 + band;
            places[sample / 32][sample % 32] = place as i16;
            sample += 1;
        }
        places
    };
    let sign = _mm512_set1_epi16(i16::MIN);
    if C == 1 {
        let low = _mm512_castsi256_si512(_mm512_cvtsepi32_epi16(a));
        return [_mm512_xor_si512(low, sign), a];
    }
    let low = _mm512_xor_si512(_mm512_packs_epi32(a, b), sign);
    let high = _mm512_xor_si512(_mm512_packs_epi32(c, d), sign);
    if C != 3 {
        let order = _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7);
        return [
            _mm512_permutexvar_epi64(order, low),
            _mm512_permutexvar_epi64(order, high),
        ];
    }
    let [first, second] = &PLACES;
    // SAFETY: 32 numbers of 16 bits are borrowed, twice.
    let (first, second) = unsafe {
        (
            _mm512_loadu_si512(first.as_ptr().cast()),
            _mm512_loadu_si512(second.as_ptr().cast()),
        )
    };
    [
        _mm512_permutex2var_epi16(low, first, high),
        _mm512_permutex2var_epi16(low, second, high),
    ]
}

/// Returns sixteen pixels of 8 bits, one behind the other.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn bytes<const C: usize>(&[a, b, c, d]: &[__m512i; 4]) -> __m512i {
    if C == 1 {
        let zero = _mm512_setzero_si512();
        return _mm512_castsi128_si512(_mm512_cvtusepi32_epi8(_mm512_max_epi32(a, zero)));
    }
    let (low, high) = (_mm512_packs_epi32(a, b), _mm512_packs_epi32(c, d));
    let pixels = _mm512_packus_epi16(low, high);
    let order = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
    let pixels = _mm512_permutexvar_epi32(order, pixels);
    if C != 3 {
        return pixels;
    }
    let of_three = _mm512_broadcast_i32x4(_mm_setr_epi8(
        0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1,
    ));
    let order = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
    _mm512_permutexvar_epi32(order, _mm512_shuffle_epi8(pixels, of_three))
}
