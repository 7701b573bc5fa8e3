//! Two taps of sixteen pixels of three bands, band by band.

use core::arch::x86_64::*;

use super::group::LOADED;
use super::job::Job;
use super::samples::{centred, load};
use crate::resampling::sample::Sample;
use crate::resampling::weights::UNIT_BITS;

/// Number of bands.
const BANDS: i32 = 3;

impl Job<'_> {
    /// Returns the values of sixteen pixels, one vector per band.
    ///
    /// # Safety
    /// From the first sample on, twice [`LOADED`] samples lie within each row.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) unsafe fn bands<S: Sample>(
        &self,
        rows: &[&[S]],
        [upper, lower]: &[__m512i; 2],
    ) -> [__m512i; 3] {
        let [above, below, ..] = rows else {
            return [_mm512_setzero_si512(); 3];
        };
        // SAFETY: that of this function.
        let (above, below) = unsafe { (self.both(above), self.both(below)) };
        let half = _mm512_set1_epi32(1 << (UNIT_BITS - 1));
        let mut values = [half; 3];
        let next = _mm512_set1_epi32(0x1_0001);
        let mut taps = _mm512_add_epi16(self.lanes.samples, _mm512_set1_epi32(BANDS << 16));
        for value in &mut values {
            let above = _mm512_madd_epi16(picked(above, taps), *upper);
            let below = _mm512_madd_epi16(picked(below, taps), *lower);
            let sum = _mm512_add_epi32(_mm512_add_epi32(above, half), below);
            *value = _mm512_srai_epi32::<UNIT_BITS>(sum);
            taps = _mm512_add_epi16(taps, next);
        }
        values
    }

    /// Replaces the values of the pixels that lie in a row.
    ///
    /// # Safety
    /// That of [`Self::bands`].
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) unsafe fn replace_bands<S: Sample>(
        &self,
        rows: &[&[S]],
        row: i32,
        [first, second, third, _]: &mut [__m512i; 4],
    ) {
        let here = _mm512_cmpeq_epi32_mask(self.lanes.whole_row, _mm512_set1_epi32(row));
        // SAFETY: that of this function.
        let [of_first, of_second, of_third] = unsafe { self.bands(rows, &self.bilinear_pairs()) };
        *first = _mm512_mask_mov_epi32(*first, here, of_first);
        *second = _mm512_mask_mov_epi32(*second, here, of_second);
        *third = _mm512_mask_mov_epi32(*third, here, of_third);
    }

    /// Loads the samples of a row.
    ///
    /// # Safety
    /// That of [`Self::bands`].
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    unsafe fn both<S: Sample>(&self, row: &[S]) -> [__m512i; 2] {
        // SAFETY: that of this function.
        let (low, high) = unsafe { (load(row, self.first), load(row, self.first + LOADED)) };
        [centred::<S>(low), centred::<S>(high)]
    }
}

/// Returns samples of two loads.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
fn picked([low, high]: [__m512i; 2], taps: __m512i) -> __m512i {
    _mm512_permutex2var_epi16(low, taps, high)
}
