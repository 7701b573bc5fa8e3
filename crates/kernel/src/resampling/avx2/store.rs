//! Values of a run as samples.

use core::arch::x86_64::*;

use super::lanes::{Values, centred};
use crate::resampling::sample::Sample;

/// Writes sixteen pixels, or fewer.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
pub(super) fn store<S: Sample, const C: usize>(values: &Values, out: &mut [[S; C]]) {
    if let Some(pixels) = out.first_chunk_mut::<16>() {
        store_all(values, pixels);
        return;
    }
    store_few(values, out);
}

/// Writes fewer than sixteen pixels.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
pub(super) fn store_few<S: Sample, const C: usize>(values: &Values, out: &mut [[S; C]]) {
    let mut all = [[S::default(); C]; 16];
    store_all(values, &mut all);
    for (to, from) in out.iter_mut().zip(all) {
        *to = from;
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
pub(super) fn store_all<S: Sample, const C: usize>(values: &Values, pixels: &mut [[S; C]; 16]) {
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
pub(super) unsafe fn store_24(place: *mut u8, pixels: __m256i, of_three: __m128i) {
    let of_three = _mm256_broadcastsi128_si256(of_three);
    let order = _mm256_setr_epi32(0, 1, 2, 4, 5, 6, 3, 7);
    let bytes = _mm256_permutevar8x32_epi32(_mm256_shuffle_epi8(pixels, of_three), order);
    // SAFETY: that of this function.
    unsafe {
        _mm_storeu_si128(place.cast(), _mm256_castsi256_si128(bytes));
        _mm_storel_epi64(place.add(16).cast(), _mm256_extracti128_si256::<1>(bytes));
    }
}
