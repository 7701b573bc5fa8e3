//! Samples of a row in the order of the lanes.

use core::arch::x86_64::*;

use super::group::{LOADED, loaded};
use crate::resampling::sample::Sample;

/// Returns the weighted sums of taps along a row.
///
/// # Safety
/// From the first on, [`loaded`] samples lie within the row.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) unsafe fn sum<S: Sample, const C: usize, const N: usize>(
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
pub(super) fn picked<const C: usize, const N: usize>(
    low: __m512i,
    high: __m512i,
    taps: __m512i,
) -> __m512i {
    if loaded(C, N) > LOADED {
        _mm512_permutex2var_epi16(low, taps, high)
    } else {
        _mm512_permutexvar_epi16(taps, low)
    }
}

/// Subtracts 2¹⁵ from samples of 16 bits.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) fn centred<S: Sample>(samples: __m512i) -> __m512i {
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
pub(super) unsafe fn load<S: Sample>(row: &[S], first: usize) -> __m512i {
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
