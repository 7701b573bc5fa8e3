//! AVX-512: sixteen lanes of 32 bits, four pixels of three or four bands or sixteen of one.
//!
//! One load and one permutation of 16-bit samples per source row put pairs of taps beside each
//! other, in the order of the lanes; a multiplication adds the products of each pair.

use core::arch::x86_64::*;

use pulp::x86::V4;

use super::band::Band;
use super::dispatch::by_size;
use super::pixel::{Places, taps_before};
use super::portable::{Row, Vectors};
use super::run::{PLACE_BITS, Run};
use super::sample::Sample;
use super::weights::{
    ColumnWeights, FRACTION_BITS, FRACTIONS, RowWeights, UNIT, UNIT_BITS, Weights,
};

/// Largest way between two places along a row, 1/2²⁴ px: with it, the taps of a group lie within
/// the samples of one load, or of two for four bands and six taps.
const LONGEST_STEP: i32 = 5 << (PLACE_BITS - 2);

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
        if N == 1 || !(1..=LONGEST_STEP).contains(&run.step[0]) {
            return false;
        }
        // SAFETY: `self` is a proof that the processor has the instructions.
        unsafe { pixels::<S, C, N>(source, weights, run, out) }.is_some()
    }
}

/// Pixels of a group.
const fn group_px(bands: usize) -> usize {
    if bands == 1 { 16 } else { 4 }
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
    let lanes = Lanes::new::<C>(&places);
    let count = out.len();
    let mut values = [_mm512_setzero_si512(); 4];
    for (number, value) in values.iter_mut().enumerate() {
        let first = number * group_px(C);
        if first >= count {
            break;
        }
        let last = (first + group_px(C)).min(count) - 1;
        let group = Group::new::<C>(&places, &lanes, [first as i32, last as i32]);
        *value = if N == 2 {
            let weights = group.bilinear(&lanes);
            group.blended::<S, C, N, _>(source, run, &lanes, &weights)?
        } else {
            let weights = group.tabulated::<C, N>(weights?, &places, &lanes);
            group.blended::<S, C, N, _>(source, run, &lanes, &weights)?
        };
    }
    store::<S, C>(values, out);
    Some(())
}

/// Places of sixteen pixels.
struct Lanes {
    /// Columns and rows, 1/2²⁴ px from the base.
    col: __m512i,
    row: __m512i,
    /// Whole part of the column, in samples from the base, in both halves of a lane.
    samples: __m512i,
}

impl Lanes {
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn new<const C: usize>(places: &Places) -> Self {
        let numbers = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let col_way = _mm512_mullo_epi32(numbers, _mm512_set1_epi32(places.col.step));
        let row_way = _mm512_mullo_epi32(numbers, _mm512_set1_epi32(places.row.step));
        let col = _mm512_add_epi32(_mm512_set1_epi32(places.col.start), col_way);
        let cols = _mm512_srai_epi32::<PLACE_BITS>(col);
        let samples = match C {
            1 => cols,
            3 => _mm512_add_epi32(cols, _mm512_add_epi32(cols, cols)),
            _ => _mm512_slli_epi32::<2>(cols),
        };
        Self {
            col,
            row: _mm512_add_epi32(_mm512_set1_epi32(places.row.start), row_way),
            samples: _mm512_or_si512(samples, _mm512_slli_epi32::<16>(samples)),
        }
    }
}

/// Weights of a group's pixels.
trait Blend<S: Sample, const C: usize, const N: usize> {
    /// Returns the group's values from N source rows, the first of whose taps is the sample
    /// `first`.
    ///
    /// # Safety
    /// The processor has the instructions.
    unsafe fn blend(&self, rows: &[&[S]; N], first: usize, taps: __m512i) -> Option<__m512i>;
}

/// Pixels whose lanes are computed together.
struct Group {
    /// Pixel of each lane.
    select: __m512i,
    /// First pixel, as a number of the run.
    first: i32,
    /// Column of the first pixel from the base.
    col: i32,
    /// Least and largest row from the base.
    rows: [i32; 2],
    /// Samples of each lane's first two taps among those of a load.
    taps: __m512i,
}

impl Group {
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn new<const C: usize>(places: &Places, lanes: &Lanes, [first, last]: [i32; 2]) -> Self {
        let col = places.col.at(first) >> PLACE_BITS;
        let a = places.row.at(first) >> PLACE_BITS;
        let b = places.row.at(last) >> PLACE_BITS;
        let bands = C as i32;
        let (select, of_bands) = if C == 1 {
            (
                _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                _mm512_set1_epi32(1 << 16),
            )
        } else {
            let fours = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
            let of_bands = _mm512_setr_epi32(
                0, 0x1_0001, 0x2_0002, 0x3_0003, 0, 0x1_0001, 0x2_0002, 0x3_0003, 0, 0x1_0001,
                0x2_0002, 0x3_0003, 0, 0x1_0001, 0x2_0002, 0x3_0003,
            );
            (
                _mm512_add_epi32(fours, _mm512_set1_epi32(first)),
                _mm512_add_epi32(of_bands, _mm512_set1_epi32(bands << 16)),
            )
        };
        let origin = _mm512_set1_epi32(col * bands * 0x1_0001);
        let from_first = _mm512_sub_epi16(_mm512_permutexvar_epi32(select, lanes.samples), origin);
        Self {
            select,
            first,
            col,
            rows: [a.min(b), a.max(b)],
            taps: _mm512_add_epi16(from_first, of_bands),
        }
    }

    /// Returns the values of the group's lanes, from every row in which one of its pixels lies.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn blended<S: Sample, const C: usize, const N: usize, W: Blend<S, C, N>>(
        &self,
        source: &Band<'_, S>,
        run: &Run,
        lanes: &Lanes,
        weights: &W,
    ) -> Option<__m512i> {
        let before = taps_before(N) as i32;
        let [base_col, base_row] = run.base_px;
        let first = usize::try_from(base_col + self.col - before).ok()? * C;
        let [low, high] = self.rows;
        let rows = source.rows::<N>(base_row + low - before)?;
        // SAFETY: this function needs the same instructions.
        let mut values = unsafe { weights.blend(rows, first, self.taps) }?;
        if high > low {
            let row_of = _mm512_permutexvar_epi32(self.select, lanes.row);
            let row_of = _mm512_srai_epi32::<PLACE_BITS>(row_of);
            for row in low + 1..=high {
                let rows = source.rows::<N>(base_row + row - before)?;
                // SAFETY: as above.
                let of_row = unsafe { weights.blend(rows, first, self.taps) }?;
                let here = _mm512_cmpeq_epi32_mask(row_of, _mm512_set1_epi32(row));
                values = _mm512_mask_mov_epi32(values, here, of_row);
            }
        }
        Some(values)
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn bilinear(&self, lanes: &Lanes) -> Bilinear {
        let unit_less_one = _mm512_set1_epi32((1 << UNIT_BITS) - 1);
        let col = _mm512_srai_epi32::<{ PLACE_BITS - UNIT_BITS }>(lanes.col);
        let row = _mm512_srai_epi32::<{ PLACE_BITS - UNIT_BITS }>(lanes.row);
        let (col, row) = (
            _mm512_and_si512(col, unit_less_one),
            _mm512_and_si512(row, unit_less_one),
        );
        let half = _mm512_set1_epi32(1 << (UNIT_BITS - 1));
        let product = _mm512_add_epi32(_mm512_madd_epi16(col, row), half);
        let both = _mm512_srai_epi32::<UNIT_BITS>(product);
        let unit = _mm512_set1_epi32(UNIT as i32);
        let (after, below) = (_mm512_sub_epi32(col, both), _mm512_sub_epi32(row, both));
        let here = _mm512_sub_epi32(_mm512_sub_epi32(unit, col), below);
        let upper = _mm512_or_si512(here, _mm512_slli_epi32::<16>(after));
        let lower = _mm512_or_si512(below, _mm512_slli_epi32::<16>(both));
        Bilinear {
            upper: _mm512_permutexvar_epi32(self.select, upper),
            lower: _mm512_permutexvar_epi32(self.select, lower),
        }
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn tabulated<const C: usize, const N: usize>(
        &self,
        weights: &Weights,
        places: &Places,
        lanes: &Lanes,
    ) -> Tabulated {
        if C == 1 {
            return Tabulated::of_lanes::<N>(weights, lanes);
        }
        let first = self.first;
        let along = |pixel: i32| weights.along(places.col.fraction::<N>(first + pixel));
        let down = |pixel: i32| weights.down(places.row.fraction::<N>(first + pixel));
        Tabulated::of_pixels::<N>(
            [along(0), along(1), along(2), along(3)],
            [down(0), down(1), down(2), down(3)],
        )
    }
}

/// Weights of two taps in the upper and the lower row.
struct Bilinear {
    upper: __m512i,
    lower: __m512i,
}

impl<S: Sample, const C: usize, const N: usize> Blend<S, C, N> for Bilinear {
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn blend(&self, rows: &[&[S]; N], first: usize, taps: __m512i) -> Option<__m512i> {
        let upper = load(rows.first()?.get(first..)?.first_chunk()?);
        let lower = load(rows.last()?.get(first..)?.first_chunk()?);
        let upper = _mm512_madd_epi16(_mm512_permutexvar_epi16(taps, upper), self.upper);
        let lower = _mm512_madd_epi16(_mm512_permutexvar_epi16(taps, lower), self.lower);
        let half = _mm512_set1_epi32(1 << (UNIT_BITS - 1));
        let sum = _mm512_add_epi32(_mm512_add_epi32(upper, lower), half);
        Some(_mm512_srai_epi32::<UNIT_BITS>(sum))
    }
}

/// Weights from tables: of pairs of taps along rows, and of rows.
struct Tabulated {
    pairs: [__m512i; 3],
    rows: [__m512; 6],
}

impl Tabulated {
    /// Returns the weights of four pixels, four lanes each.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    fn of_pixels<const N: usize>(along: [&RowWeights; 4], down: [&ColumnWeights; 4]) -> Self {
        let [a, b, c, d] = along;
        let along = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(whole(a)), whole(b));
        let along = _mm512_inserti32x4::<2>(along, whole(c));
        let along = _mm512_inserti32x4::<3>(along, whole(d));
        let [a, b, c, d] = down;
        let low = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(half(a, 0)), half(b, 0));
        let low = _mm512_insertf32x4::<2>(low, half(c, 0));
        let low = _mm512_insertf32x4::<3>(low, half(d, 0));
        let mut high = low;
        if N > 4 {
            high = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(half(a, 1)), half(b, 1));
            high = _mm512_insertf32x4::<2>(high, half(c, 1));
            high = _mm512_insertf32x4::<3>(high, half(d, 1));
        }
        Self {
            pairs: [
                _mm512_shuffle_epi32::<0b00_00_00_00>(along),
                _mm512_shuffle_epi32::<0b01_01_01_01>(along),
                _mm512_shuffle_epi32::<0b10_10_10_10>(along),
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

impl<S: Sample, const C: usize, const N: usize> Blend<S, C, N> for Tabulated {
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn blend(&self, rows: &[&[S]; N], first: usize, taps: __m512i) -> Option<__m512i> {
        let next = _mm512_set1_epi16(2 * C as i16);
        let second = _mm512_add_epi16(taps, next);
        let taps = [taps, second, _mm512_add_epi16(second, next)];
        let mut values = _mm512_setzero_ps();
        for (number, (row, weight)) in rows.iter().zip(&self.rows).enumerate() {
            let samples = row.get(first..)?;
            let low = load(samples.first_chunk()?);
            let mut sum = _mm512_setzero_si512();
            if C * (4 + N) > LOADED && C > 1 {
                let high = load(samples.get(LOADED..)?.first_chunk()?);
                for (taps, pairs) in taps.iter().zip(&self.pairs).take(N / 2) {
                    let samples = _mm512_permutex2var_epi16(low, *taps, high);
                    sum = _mm512_add_epi32(sum, _mm512_madd_epi16(samples, *pairs));
                }
            } else {
                for (taps, pairs) in taps.iter().zip(&self.pairs).take(N / 2) {
                    let samples = _mm512_permutexvar_epi16(*taps, low);
                    sum = _mm512_add_epi32(sum, _mm512_madd_epi16(samples, *pairs));
                }
            }
            let product = _mm512_mul_ps(_mm512_cvtepi32_ps(sum), *weight);
            values = if number == 0 {
                product
            } else {
                _mm512_add_ps(values, product)
            };
        }
        Some(_mm512_cvtps_epi32(values))
    }
}

/// Loads samples as the numbers that are computed with.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn load<S: Sample>(samples: &[S; LOADED]) -> __m512i {
    let place = samples.as_ptr();
    if S::BITS == 8 {
        // SAFETY: 32 samples of 8 bits are borrowed.
        _mm512_cvtepu8_epi16(unsafe { _mm256_loadu_si256(place.cast()) })
    } else {
        // SAFETY: 32 samples of 16 bits are borrowed.
        let samples = unsafe { _mm512_loadu_si512(place.cast()) };
        _mm512_xor_si512(samples, _mm512_set1_epi16(i16::MIN))
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
fn store<S: Sample, const C: usize>(groups: [__m512i; 4], out: &mut [[S; C]]) {
    if S::BITS == 8 {
        let bytes = bytes::<C>(groups);
        if let Some(pixels) = out.first_chunk_mut::<16>() {
            let place = pixels.as_flattened_mut().as_mut_ptr();
            match C {
                // SAFETY: 16, 48 or 64 samples of 8 bits are borrowed.
                1 => unsafe { _mm_storeu_si128(place.cast(), _mm512_castsi512_si128(bytes)) },
                3 => {
                    let high = _mm512_extracti32x4_epi32::<2>(bytes);
                    // SAFETY: as above.
                    unsafe {
                        _mm256_storeu_si256(place.cast(), _mm512_castsi512_si256(bytes));
                        _mm_storeu_si128(place.add(32).cast(), high);
                    }
                }
                // SAFETY: as above.
                _ => unsafe { _mm512_storeu_si512(place.cast(), bytes) },
            }
            return;
        }
        let mut all = [0_u8; 64];
        // SAFETY: 64 bytes are borrowed.
        unsafe { _mm512_storeu_si512(all.as_mut_ptr().cast(), bytes) };
        for (to, from) in out.as_flattened_mut().iter_mut().zip(all) {
            *to = S::saturated(i32::from(from));
        }
        return;
    }
    let [low, high] = words::<C>(groups);
    if let Some(pixels) = out.first_chunk_mut::<16>() {
        let place = pixels.as_flattened_mut().as_mut_ptr();
        match C {
            // SAFETY: 16, 48 or 64 samples of 16 bits are borrowed.
            1 => unsafe { _mm256_storeu_si256(place.cast(), _mm512_castsi512_si256(low)) },
            3 => unsafe {
                _mm512_storeu_si512(place.cast(), low);
                _mm256_storeu_si256(place.add(32).cast(), _mm512_castsi512_si256(high));
            },
            _ => unsafe {
                _mm512_storeu_si512(place.cast(), low);
                _mm512_storeu_si512(place.add(32).cast(), high);
            },
        }
        return;
    }
    let mut all = [0_u16; 64];
    // SAFETY: 64 samples of 16 bits are borrowed.
    unsafe {
        _mm512_storeu_si512(all.as_mut_ptr().cast(), low);
        _mm512_storeu_si512(all.as_mut_ptr().add(32).cast(), high);
    }
    for (to, from) in out.as_flattened_mut().iter_mut().zip(all) {
        *to = S::saturated(i32::from(from) - (1 << 15));
    }
}

/// Returns sixteen pixels of 16 bits, one behind the other.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn words<const C: usize>([a, b, c, d]: [__m512i; 4]) -> [__m512i; 2] {
    let sign = _mm512_set1_epi16(i16::MIN);
    let [a, b] = [_mm512_cvtsepi32_epi16(a), _mm512_cvtsepi32_epi16(b)];
    let [c, d] = [_mm512_cvtsepi32_epi16(c), _mm512_cvtsepi32_epi16(d)];
    let low = _mm512_inserti64x4::<1>(_mm512_castsi256_si512(a), b);
    let high = _mm512_inserti64x4::<1>(_mm512_castsi256_si512(c), d);
    let (low, high) = (_mm512_xor_si512(low, sign), _mm512_xor_si512(high, sign));
    if C != 3 {
        return [low, high];
    }
    let (first, second) = (words_of_three(0), words_of_three(32));
    [
        _mm512_permutex2var_epi16(low, first, high),
        _mm512_permutex2var_epi16(low, second, high),
    ]
}

/// Returns the samples, of those with a fourth band, that stay without it, from one on.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn words_of_three(first: usize) -> __m512i {
    const PLACES: [i16; 64] = {
        let mut places = [0; 64];
        let mut sample = 0;
        while sample < 48 {
            places[sample] = (sample / 3 * 4 + sample % 3) as i16;
            sample += 1;
        }
        places
    };
    let places = if first == 0 {
        PLACES.first_chunk::<32>()
    } else {
        PLACES.last_chunk::<32>()
    };
    let places = places.unwrap_or(&[0; 32]);
    // SAFETY: 32 numbers of 16 bits are borrowed.
    unsafe { _mm512_loadu_si512(places.as_ptr().cast()) }
}

/// Returns sixteen pixels of 8 bits, one behind the other.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn bytes<const C: usize>([a, b, c, d]: [__m512i; 4]) -> __m512i {
    let zero = _mm512_setzero_si512();
    let a = _mm512_cvtusepi32_epi8(_mm512_max_epi32(a, zero));
    let b = _mm512_cvtusepi32_epi8(_mm512_max_epi32(b, zero));
    let c = _mm512_cvtusepi32_epi8(_mm512_max_epi32(c, zero));
    let d = _mm512_cvtusepi32_epi8(_mm512_max_epi32(d, zero));
    let all = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(a), b);
    let all = _mm512_inserti32x4::<2>(all, c);
    let all = _mm512_inserti32x4::<3>(all, d);
    if C != 3 {
        return all;
    }
    let of_three = _mm512_broadcast_i32x4(_mm_setr_epi8(
        0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1,
    ));
    let order = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
    _mm512_permutexvar_epi32(order, _mm512_shuffle_epi8(all, of_three))
}
