//! Values of a run from its source rows.

use core::arch::x86_64::*;

use super::group::is_by_bands;
use super::lanes::Lanes;
use super::samples::{centred, load, sum};
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
    pub(super) lanes: Lanes,
    /// Sample of a row from which the columns of the places are counted.
    pub(super) first: usize,
}

impl Job<'_> {
    /// Computes the values of a run from N source rows.
    ///
    /// # Safety
    /// From the first tap of every group on, [`loaded`] samples lie within each row.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) unsafe fn fill<S: Sample, const C: usize, const N: usize>(
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
            } else if is_by_bands(C, N) {
                [*first, *second, *third] = self.bands(rows.as_slice(), &self.bilinear_pairs());
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
    pub(super) unsafe fn across_rows<S: Sample, const C: usize, const N: usize>(
        &self,
        source: &Band<'_, S>,
        run: &Run,
        [first, last]: [i32; 2],
        values: &mut [__m512i; 4],
    ) -> Option<()> {
        let [_, base_row] = run.base_px;
        for row in first.min(last)..=first.max(last) {
            if row == first {
                continue;
            }
            let before = taps_before(N) as i32;
            let rows = source.rows::<N>(base_row.wrapping_add(row).wrapping_sub(before))?;
            if is_by_bands(C, N) {
                // SAFETY: that of this function.
                unsafe { self.replace_bands(rows.as_slice(), row, values) };
                continue;
            }
            let [of_first, of_second, of_third, of_fourth] = &mut *values;
            // SAFETY: that of this function.
            unsafe {
                self.replace::<S, C, N, 0>(rows, row, of_first)?;
                if C > 1 {
                    self.replace::<S, C, N, 1>(rows, row, of_second)?;
                    self.replace::<S, C, N, 2>(rows, row, of_third)?;
                    self.replace::<S, C, N, 3>(rows, row, of_fourth)?;
                }
            }
        }
        Some(())
    }

    /// Replaces the values of a group's pixels that lie in a row.
    ///
    /// # Safety
    /// That of [`Self::fill`].
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn replace<S: Sample, const C: usize, const N: usize, const G: i32>(
        &self,
        rows: &[&[S]; N],
        row: i32,
        value: &mut __m512i,
    ) -> Option<()> {
        let row_of = Self::spread::<C, G>(self.lanes.whole_row);
        let here = _mm512_cmpeq_epi32_mask(row_of, _mm512_set1_epi32(row));
        if here == 0 {
            return Some(());
        }
        // SAFETY: that of this function.
        let of_row = unsafe {
            if N == 1 {
                self.nearest::<S, C, G>(rows.as_slice())
            } else if N == 2 {
                self.bilinear::<S, C, G>(rows.as_slice(), &self.bilinear_pairs())
            } else if C == 1 {
                let weights = Tabulated::of_lanes::<N>(self.weights?, &self.lanes);
                self.tabulated::<S, C, N, G>(rows, &weights)
            } else {
                let weights = Tabulated::of_group::<N>(self.weights?, &self.places, G);
                self.tabulated::<S, C, N, G>(rows, &weights)
            }
        };
        *value = _mm512_mask_mov_epi32(*value, here, of_row);
        Some(())
    }

    /// Returns the lanes of a group from one lane per pixel.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) fn spread<const C: usize, const G: i32>(of_pixels: __m512i) -> __m512i {
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
    pub(super) fn first<const C: usize, const G: i32>(&self) -> usize {
        self.first + (self.places.col.at(4 * G) >> PLACE_BITS) as usize * C
    }

    /// Returns the places of the first two taps of a group's lanes among the loaded samples.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) fn taps<const C: usize, const G: i32>(&self) -> __m512i {
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
    pub(super) unsafe fn nearest<S: Sample, const C: usize, const G: i32>(
        &self,
        rows: &[&[S]],
    ) -> __m512i {
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
    pub(super) fn bilinear_pairs(&self) -> [__m512i; 2] {
        let unit_less_one = _mm512_set1_epi32((1 << UNIT_BITS) - 1);
        let col = _mm512_srai_epi32::<{ PLACE_BITS - UNIT_BITS }>(self.lanes.col);
        let row = _mm512_srai_epi32::<{ PLACE_BITS - UNIT_BITS }>(self.lanes.row);
        let col = _mm512_and_si512(col, unit_less_one);
        let row = _mm512_and_si512(row, unit_less_one);
        let half = _mm512_set1_epi32(1 << (UNIT_BITS - 1));
        let product = _mm512_add_epi32(_mm512_madd_epi16(col, row), half);
        let both = _mm512_srai_epi32::<UNIT_BITS>(product);
        let unit = _mm512_set1_epi32(i32::from(UNIT));
        let (after, below) = (_mm512_sub_epi32(col, both), _mm512_sub_epi32(row, both));
        let here = _mm512_sub_epi32(_mm512_sub_epi32(unit, col), below);
        [
            _mm512_or_si512(here, _mm512_slli_epi32::<16>(after)),
            _mm512_or_si512(below, _mm512_slli_epi32::<16>(both)),
        ]
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) unsafe fn bilinear<S: Sample, const C: usize, const G: i32>(
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
    pub(super) unsafe fn tabulated<S: Sample, const C: usize, const N: usize, const G: i32>(
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
