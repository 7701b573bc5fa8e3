//! AVX2: eight lanes of 32 bits, two pixels of three or four bands or eight of one.
//!
//! The taps of a pixel of several bands are loaded beside each other and put in the order of the
//! lanes by a shuffle of bytes; those of one band are gathered in pairs. A multiplication adds the
//! products of each pair.

#![expect(
    clippy::wildcard_imports,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "intrinsics, and numbers of lanes, taps and bands"
)]

use core::arch::x86_64::*;

use pulp::x86::V3;

use super::band::Band;
use super::dispatch::by_size;
use super::pixel::{Places, taps_before};
use super::portable::{Row, Vectors};
use super::run::{PLACE_BITS, RUN_PX, Run};
use super::sample::Sample;
use super::weights::{
    ColumnWeights, FRACTION_BITS, FRACTIONS, RowWeights, UNIT, UNIT_BITS, Weights,
};

/// Largest way between two places along a row, 1/2²⁴ px.
const LONGEST_STEP: i32 = 4 << PLACE_BITS;

/// Samples by which the memory that is asked for lies ahead of a run; it need not exist.
const AHEAD: usize = 1024;

/// Samples of a load.
const LOADED: usize = 8;

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

/// Values of a run, eight lanes each.
type Values = [__m256i; 8];

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

/// Places of eight pixels, 1/2²⁴ px.
struct Lanes {
    col: __m256i,
    row: __m256i,
}

impl Lanes {
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    fn new(places: &Places, first: i32) -> Self {
        let numbers = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let col_way = _mm256_mullo_epi32(numbers, _mm256_set1_epi32(places.col.step));
        let row_way = _mm256_mullo_epi32(numbers, _mm256_set1_epi32(places.row.step));
        Self {
            col: _mm256_add_epi32(_mm256_set1_epi32(places.col.at(first)), col_way),
            row: _mm256_add_epi32(_mm256_set1_epi32(places.row.at(first)), row_way),
        }
    }
}

/// Returns the lanes of a pair of pixels from one lane per pixel.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn spread<const C: usize>(of_pixels: __m256i, pair: i32) -> __m256i {
    if C == 1 {
        return of_pixels;
    }
    let (a, b) = (2 * pair, 2 * pair + 1);
    _mm256_permutevar8x32_epi32(of_pixels, _mm256_setr_epi32(a, a, a, a, b, b, b, b))
}

/// A run with its weights.
struct Job<'a> {
    weights: Option<&'a Weights>,
    places: Places,
    lanes: [Lanes; 2],
    /// Sample of a row from which the columns of the places are counted.
    first: usize,
}

impl Job<'_> {
    /// Computes the values of a run from N source rows.
    ///
    /// # Safety
    /// From the first tap of every pair of taps on, [`LOADED`] samples lie within each row.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    unsafe fn fill<S: Sample, const C: usize, const N: usize>(
        &self,
        rows: &[&[S]; N],
        values: &mut Values,
    ) -> Option<()> {
        let [low, high] = &self.lanes;
        if N == 2 {
            let [above, below, ..] = rows.as_slice() else {
                return None;
            };
            let (of_low, of_high) = (bilinear_pairs(low), bilinear_pairs(high));
            for (number, value) in values.iter_mut().enumerate() {
                if C == 1 && number == 2 {
                    break;
                }
                let is_low = number < if C == 1 { 1 } else { 4 };
                let [upper, lower] = if is_low { &of_low } else { &of_high };
                let pair = number as i32 & 3;
                // SAFETY: that of this function.
                let (above, below) = unsafe {
                    (
                        self.pairs::<S, C>(above, number, 0),
                        self.pairs::<S, C>(below, number, 0),
                    )
                };
                let above = _mm256_madd_epi16(above, spread::<C>(*upper, pair));
                let below = _mm256_madd_epi16(below, spread::<C>(*lower, pair));
                let half = _mm256_set1_epi32(1 << (UNIT_BITS - 1));
                let sum = _mm256_add_epi32(_mm256_add_epi32(above, half), below);
                *value = _mm256_srai_epi32::<{ UNIT_BITS as i32 }>(sum);
            }
            return Some(());
        }
        let weights = self.weights?;
        for (number, value) in values.iter_mut().enumerate() {
            if C == 1 && number == 2 {
                break;
            }
            let of_pixels = if C == 1 {
                Tabulated::of_lanes::<N>(weights, if number == 0 { low } else { high })
            } else {
                Tabulated::of_pair::<N>(weights, &self.places, 2 * number as i32)
            };
            // SAFETY: that of this function.
            *value = unsafe { self.tabulated::<S, C, N>(rows, number, &of_pixels) };
        }
        Some(())
    }

    /// Replaces the values of pixels that lie in other rows than the first.
    ///
    /// # Safety
    /// That of [`Self::fill`], for all rows of the source that are in memory.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline(never)]
    unsafe fn across_rows<S: Sample, const C: usize, const N: usize>(
        &self,
        source: &Band<'_, S>,
        run: &Run,
        [first, last]: [i32; 2],
        values: &mut Values,
    ) -> Option<()> {
        let [_, base_row] = run.base_px;
        for row in first.min(last)..=first.max(last) {
            if row == first {
                continue;
            }
            let before = taps_before(N) as i32;
            let rows = source.rows::<N>(base_row.wrapping_add(row).wrapping_sub(before))?;
            let mut of_row = [_mm256_setzero_si256(); 8];
            // SAFETY: that of this function.
            unsafe { self.fill::<S, C, N>(rows, &mut of_row) }?;
            let row = _mm256_set1_epi32(row);
            for (number, (value, of_row)) in values.iter_mut().zip(of_row).enumerate() {
                let [low, high] = &self.lanes;
                let is_low = number < if C == 1 { 1 } else { 4 };
                let lanes = if is_low { low } else { high };
                let row_of = _mm256_srai_epi32::<{ PLACE_BITS as i32 }>(lanes.row);
                let row_of = spread::<C>(row_of, number as i32 & 3);
                let here = _mm256_cmpeq_epi32(row_of, row);
                *value = _mm256_blendv_epi8(*value, of_row, here);
            }
        }
        Some(())
    }

    /// Returns the samples of a pair of taps of the pixels of a number of values.
    ///
    /// # Safety
    /// From the first of the taps on, [`LOADED`] samples lie within the row.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    unsafe fn pairs<S: Sample, const C: usize>(
        &self,
        row: &[S],
        number: usize,
        pair: usize,
    ) -> __m256i {
        let first = self.first + 2 * C * pair;
        let place = row.as_ptr();
        if C == 1 {
            let [low, high] = &self.lanes;
            let col = if number == 0 { low.col } else { high.col };
            let col = _mm256_srai_epi32::<{ PLACE_BITS as i32 }>(col);
            // SAFETY: that of this function; four bytes are read from each place.
            return unsafe {
                let place = place.add(first).cast();
                if S::BITS == 8 {
                    let low_bytes = _mm256_i32gather_epi32::<1>(place, col);
                    let order = _mm256_broadcastsi128_si256(_mm_setr_epi8(
                        0, -1, 1, -1, 4, -1, 5, -1, 8, -1, 9, -1, 12, -1, 13, -1,
                    ));
                    _mm256_shuffle_epi8(low_bytes, order)
                } else {
                    centred(_mm256_i32gather_epi32::<2>(place, col))
                }
            };
        }
        let col = |pixel: i32| (self.places.col.at(pixel) >> PLACE_BITS) as usize * C;
        let pixel = 2 * number as i32;
        let (a, b) = (first + col(pixel), first + col(pixel + 1));
        debug_assert!(b + LOADED <= row.len(), "{b} of {}", row.len());
        let samples = if S::BITS == 8 {
            // SAFETY: that of this function.
            let (a, b) = unsafe {
                (
                    _mm_loadl_epi64(place.add(a).cast()),
                    _mm_loadl_epi64(place.add(b).cast()),
                )
            };
            _mm256_cvtepu8_epi16(_mm_unpacklo_epi64(a, b))
        } else {
            // SAFETY: that of this function.
            let (a, b) = unsafe {
                (
                    _mm_loadu_si128(place.add(a).cast()),
                    _mm_loadu_si128(place.add(b).cast()),
                )
            };
            centred(_mm256_inserti128_si256::<1>(_mm256_castsi128_si256(a), b))
        };
        let order = if C == 3 {
            _mm_setr_epi8(0, 1, 6, 7, 2, 3, 8, 9, 4, 5, 10, 11, 6, 7, 12, 13)
        } else {
            _mm_setr_epi8(0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15)
        };
        _mm256_shuffle_epi8(samples, _mm256_broadcastsi128_si256(order))
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    unsafe fn tabulated<S: Sample, const C: usize, const N: usize>(
        &self,
        rows: &[&[S]; N],
        number: usize,
        weights: &Tabulated,
    ) -> __m256i {
        let [a, b, c, d, rest @ ..] = rows.as_slice() else {
            return _mm256_setzero_si256();
        };
        let [of_a, of_b, of_c, of_d, of_e, of_f] = weights.rows;
        // SAFETY: that of this function.
        unsafe {
            let a = _mm256_mul_ps(self.sum::<S, C, N>(a, number, weights), of_a);
            let b = _mm256_mul_ps(self.sum::<S, C, N>(b, number, weights), of_b);
            let c = _mm256_mul_ps(self.sum::<S, C, N>(c, number, weights), of_c);
            let d = _mm256_mul_ps(self.sum::<S, C, N>(d, number, weights), of_d);
            let mut values = _mm256_add_ps(_mm256_add_ps(_mm256_add_ps(a, b), c), d);
            if let [e, f] = rest {
                let e = _mm256_mul_ps(self.sum::<S, C, N>(e, number, weights), of_e);
                let f = _mm256_mul_ps(self.sum::<S, C, N>(f, number, weights), of_f);
                values = _mm256_add_ps(_mm256_add_ps(values, e), f);
            }
            _mm256_cvtps_epi32(values)
        }
    }

    /// Returns the weighted sums of taps along a row.
    ///
    /// # Safety
    /// That of [`Self::fill`].
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    unsafe fn sum<S: Sample, const C: usize, const N: usize>(
        &self,
        row: &[S],
        number: usize,
        weights: &Tabulated,
    ) -> __m256 {
        let [of_one, of_two, of_three] = weights.pairs;
        // SAFETY: that of this function.
        unsafe {
            let one = _mm256_madd_epi16(self.pairs::<S, C>(row, number, 0), of_one);
            let two = _mm256_madd_epi16(self.pairs::<S, C>(row, number, 1), of_two);
            let mut sum = _mm256_add_epi32(one, two);
            if N > 4 {
                let three = _mm256_madd_epi16(self.pairs::<S, C>(row, number, 2), of_three);
                sum = _mm256_add_epi32(sum, three);
            }
            _mm256_cvtepi32_ps(sum)
        }
    }
}

/// Subtracts 2¹⁵ from samples of 16 bits.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn centred(samples: __m256i) -> __m256i {
    _mm256_xor_si256(samples, _mm256_set1_epi16(i16::MIN))
}

/// Returns the weights of the upper and the lower pair of taps of every pixel.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn bilinear_pairs(lanes: &Lanes) -> [__m256i; 2] {
    let unit_less_one = _mm256_set1_epi32((1 << UNIT_BITS) - 1);
    let col = _mm256_srai_epi32::<{ (PLACE_BITS - UNIT_BITS) as i32 }>(lanes.col);
    let row = _mm256_srai_epi32::<{ (PLACE_BITS - UNIT_BITS) as i32 }>(lanes.row);
    let col = _mm256_and_si256(col, unit_less_one);
    let row = _mm256_and_si256(row, unit_less_one);
    let half = _mm256_set1_epi32(1 << (UNIT_BITS - 1));
    let product = _mm256_add_epi32(_mm256_madd_epi16(col, row), half);
    let both = _mm256_srai_epi32::<{ UNIT_BITS as i32 }>(product);
    let unit = _mm256_set1_epi32(UNIT as i32);
    let (after, below) = (_mm256_sub_epi32(col, both), _mm256_sub_epi32(row, both));
    let here = _mm256_sub_epi32(_mm256_sub_epi32(unit, col), below);
    [
        _mm256_or_si256(here, _mm256_slli_epi32::<16>(after)),
        _mm256_or_si256(below, _mm256_slli_epi32::<16>(both)),
    ]
}

/// Weights from tables: of pairs of taps along rows, and of rows.
struct Tabulated {
    pairs: [__m256i; 3],
    rows: [__m256; 6],
}

impl Tabulated {
    /// Returns the weights of two pixels, four lanes each.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    fn of_pair<const N: usize>(weights: &Weights, places: &Places, pixel: i32) -> Self {
        let a = whole(weights.along(places.col.fraction::<N>(pixel)));
        let b = whole(weights.along(places.col.fraction::<N>(pixel + 1)));
        let pairs = _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(a), b);
        let a = weights.down(places.row.fraction::<N>(pixel));
        let b = weights.down(places.row.fraction::<N>(pixel + 1));
        let low = _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(half(a, 0)), half(b, 0));
        let mut high = low;
        if N > 4 {
            high = _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(half(a, 1)), half(b, 1));
        }
        Self {
            pairs: [
                _mm256_shuffle_epi32::<0b00_00_00_00>(pairs),
                _mm256_shuffle_epi32::<0b01_01_01_01>(pairs),
                _mm256_shuffle_epi32::<0b10_10_10_10>(pairs),
            ],
            rows: [
                _mm256_permute_ps::<0b00_00_00_00>(low),
                _mm256_permute_ps::<0b01_01_01_01>(low),
                _mm256_permute_ps::<0b10_10_10_10>(low),
                _mm256_permute_ps::<0b11_11_11_11>(low),
                _mm256_permute_ps::<0b00_00_00_00>(high),
                _mm256_permute_ps::<0b01_01_01_01>(high),
            ],
        }
    }

    /// Returns the weights of eight pixels of one band, a lane each.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    fn of_lanes<const N: usize>(weights: &Weights, lanes: &Lanes) -> Self {
        let last = _mm256_set1_epi32(FRACTIONS as i32 - 1);
        let col = _mm256_srai_epi32::<{ (PLACE_BITS - FRACTION_BITS) as i32 }>(lanes.col);
        let row = _mm256_srai_epi32::<{ (PLACE_BITS - FRACTION_BITS) as i32 }>(lanes.row);
        // Numbers of 32 bits: 4 to an entry of the one table, 8 to one of the other.
        let col = _mm256_slli_epi32::<2>(_mm256_and_si256(col, last));
        let row = _mm256_slli_epi32::<3>(_mm256_and_si256(row, last));
        let mut pairs = [_mm256_setzero_si256(); 3];
        for (number, pair) in pairs.iter_mut().enumerate().take(N / 2) {
            let index = _mm256_add_epi32(col, _mm256_set1_epi32(number as i32));
            // SAFETY: the index of an entry is less than FRACTIONS, that in the entry less than 4.
            *pair = unsafe { _mm256_i32gather_epi32::<4>(weights.rows.as_ptr().cast(), index) };
        }
        let mut rows = [_mm256_setzero_ps(); 6];
        for (number, weight) in rows.iter_mut().enumerate().take(N) {
            let index = _mm256_add_epi32(row, _mm256_set1_epi32(number as i32));
            // SAFETY: the index of an entry is less than FRACTIONS, that in the entry less than 8.
            *weight = unsafe { _mm256_i32gather_ps::<4>(weights.columns.as_ptr().cast(), index) };
        }
        Self { pairs, rows }
    }
}

/// Loads the weights of a row.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn whole(weights: &RowWeights) -> __m128i {
    // SAFETY: eight weights of 16 bits are borrowed.
    unsafe { _mm_loadu_si128(weights.as_ptr().cast()) }
}

/// Loads the first or the last four weights of a column.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn half(weights: &ColumnWeights, number: usize) -> __m128 {
    let halves = weights.as_chunks::<4>().0;
    let four = halves.get(number & 1).unwrap_or(&[0.0; 4]);
    // SAFETY: four weights of 32 bits are borrowed.
    unsafe { _mm_loadu_ps(four.as_ptr()) }
}

/// Writes sixteen pixels, or fewer.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn store<S: Sample, const C: usize>(values: &Values, out: &mut [[S; C]]) {
    if let Some(pixels) = out.first_chunk_mut::<16>() {
        store_all(values, pixels);
        return;
    }
    store_few(values, out);
}

/// Writes fewer than sixteen pixels.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
fn store_few<S: Sample, const C: usize>(values: &Values, out: &mut [[S; C]]) {
    let mut all = [[S::default(); C]; 16];
    store_all(values, &mut all);
    for (to, from) in out.iter_mut().zip(all) {
        *to = from;
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
fn store_all<S: Sample, const C: usize>(values: &Values, pixels: &mut [[S; C]; 16]) {
    let [a, b, c, d, e, f, g, h] = *values;
    let place = pixels.as_flattened_mut().as_mut_ptr();
    let in_turn = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
    if C == 1 {
        let words = _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packs_epi32(a, b));
        if S::BITS == 8 {
            let bytes = _mm256_packus_epi16(words, words);
            let bytes = _mm256_permute4x64_epi64::<0b11_01_10_00>(bytes);
            // SAFETY: 16 samples of 8 bits are borrowed.
            unsafe { _mm_storeu_si128(place.cast(), _mm256_castsi256_si128(bytes)) };
        } else {
            // SAFETY: 16 samples of 16 bits are borrowed.
            unsafe { _mm256_storeu_si256(place.cast(), centred(words)) };
        }
        return;
    }
    if S::BITS == 8 {
        let low = _mm256_packus_epi16(_mm256_packs_epi32(a, b), _mm256_packs_epi32(c, d));
        let high = _mm256_packus_epi16(_mm256_packs_epi32(e, f), _mm256_packs_epi32(g, h));
        let low = _mm256_permutevar8x32_epi32(low, in_turn);
        let high = _mm256_permutevar8x32_epi32(high, in_turn);
        let of_three = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
        // SAFETY: 48 or 64 samples of 8 bits are borrowed.
        unsafe {
            if C == 3 {
                store_24(place.cast(), low, of_three);
                store_24(place.add(24).cast(), high, of_three);
            } else {
                _mm256_storeu_si256(place.cast(), low);
                _mm256_storeu_si256(place.add(32).cast(), high);
            }
        }
        return;
    }
    let words = [
        _mm256_packs_epi32(a, b),
        _mm256_packs_epi32(c, d),
        _mm256_packs_epi32(e, f),
        _mm256_packs_epi32(g, h),
    ];
    for (number, words) in words.into_iter().enumerate() {
        let words = _mm256_permute4x64_epi64::<0b11_01_10_00>(centred(words));
        let of_three = _mm_setr_epi8(0, 1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13, -1, -1, -1, -1);
        // SAFETY: 48 or 64 samples of 16 bits are borrowed, 12 or 16 of them for each of four.
        unsafe {
            let place = place.add(4 * C * number);
            if C == 3 {
                store_24(place.cast(), words, of_three);
            } else {
                _mm256_storeu_si256(place.cast(), words);
            }
        }
    }
}

/// Writes 24 bytes: those that are chosen from each half of a vector.
///
/// # Safety
/// 24 bytes may be written to the place.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
unsafe fn store_24(place: *mut u8, pixels: __m256i, of_three: __m128i) {
    let of_three = _mm256_broadcastsi128_si256(of_three);
    let order = _mm256_setr_epi32(0, 1, 2, 4, 5, 6, 3, 7);
    let bytes = _mm256_permutevar8x32_epi32(_mm256_shuffle_epi8(pixels, of_three), order);
    // SAFETY: that of this function.
    unsafe {
        _mm_storeu_si128(place.cast(), _mm256_castsi256_si128(bytes));
        _mm_storel_epi64(place.add(16).cast(), _mm256_extracti128_si256::<1>(bytes));
    }
}
