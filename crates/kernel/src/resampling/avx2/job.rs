//! Values of a run from its source rows.

use core::arch::x86_64::*;

use super::lanes::{LOADED, Lanes, Values, centred, spread};
use super::tabulated::Tabulated;
use crate::resampling::band::Band;
use crate::resampling::pixel::{Places, taps_before};
use crate::resampling::run::{PLACE_BITS, Run};
use crate::resampling::sample::Sample;
use crate::resampling::weights::{UNIT, UNIT_BITS, Weights};

/// A run with its weights.
pub(super) struct Job<'a> {
    pub(super) weights: Option<&'a Weights>,
    pub(super) places: Places,
    pub(super) lanes: [Lanes; 2],
    /// Sample of a row from which the columns of the places are counted.
    pub(super) first: usize,
}

impl Job<'_> {
    /// Computes the values of a run from N source rows.
    ///
    /// # Safety
    /// From the first tap of every pair of taps on, [`LOADED`] samples lie within each row.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    pub(super) unsafe fn fill<S: Sample, const C: usize, const N: usize>(
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
    pub(super) unsafe fn across_rows<S: Sample, const C: usize, const N: usize>(
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
    pub(super) unsafe fn pairs<S: Sample, const C: usize>(
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
    pub(super) unsafe fn tabulated<S: Sample, const C: usize, const N: usize>(
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
    pub(super) unsafe fn sum<S: Sample, const C: usize, const N: usize>(
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

/// Returns the weights of the upper and the lower pair of taps of every pixel.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
pub(super) fn bilinear_pairs(lanes: &Lanes) -> [__m256i; 2] {
    let unit_less_one = _mm256_set1_epi32((1 << UNIT_BITS) - 1);
    let col = _mm256_srai_epi32::<{ (PLACE_BITS - UNIT_BITS) as i32 }>(lanes.col);
    let row = _mm256_srai_epi32::<{ (PLACE_BITS - UNIT_BITS) as i32 }>(lanes.row);
    let col = _mm256_and_si256(col, unit_less_one);
    let row = _mm256_and_si256(row, unit_less_one);
    let half = _mm256_set1_epi32(1 << (UNIT_BITS - 1));
    let product = _mm256_add_epi32(_mm256_madd_epi16(col, row), half);
    let both = _mm256_srai_epi32::<{ UNIT_BITS as i32 }>(product);
    let unit = _mm256_set1_epi32(i32::from(UNIT));
    let (after, below) = (_mm256_sub_epi32(col, both), _mm256_sub_epi32(row, both));
    let here = _mm256_sub_epi32(_mm256_sub_epi32(unit, col), below);
    [
        _mm256_or_si256(here, _mm256_slli_epi32::<16>(after)),
        _mm256_or_si256(below, _mm256_slli_epi32::<16>(both)),
    ]
}
