//! Values of a run as samples.

use core::arch::x86_64::*;

use super::group::is_by_bands;
use crate::resampling::sample::Sample;

/// Writes sixteen pixels, or fewer, from four groups.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) fn store<S: Sample, const C: usize, const N: usize>(
    groups: &[__m512i; 4],
    out: &mut [[S; C]],
) {
    if let Some(pixels) = out.first_chunk_mut::<16>() {
        if S::BITS == 8 {
            store_bytes(bytes::<C, N>(groups), pixels);
        } else {
            store_words(words::<C, N>(groups), pixels);
        }
        return;
    }
    store_few::<S, C, N>(groups, out);
}

/// Writes fewer than sixteen pixels.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline(never)]
pub(super) fn store_few<S: Sample, const C: usize, const N: usize>(
    groups: &[__m512i; 4],
    out: &mut [[S; C]],
) {
    let mut all = [[S::default(); C]; 16];
    if S::BITS == 8 {
        store_bytes(bytes::<C, N>(groups), &mut all);
    } else {
        store_words(words::<C, N>(groups), &mut all);
    }
    for (to, from) in out.iter_mut().zip(all) {
        *to = from;
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) fn store_bytes<S: Sample, const C: usize>(bytes: __m512i, pixels: &mut [[S; C]; 16]) {
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
pub(super) fn store_words<S: Sample, const C: usize>(
    [low, high]: [__m512i; 2],
    pixels: &mut [[S; C]; 16],
) {
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

/// Returns the samples of sixteen pixels of three bands among those of two vectors: of which each
/// has pixels of the one group and of the next in turn, or fours of the first and of the second
/// band and the third band.
#[expect(clippy::indexing_slicing, reason = "when it is compiled")]
const fn interleaved(by_bands: bool) -> [[i16; 32]; 2] {
    let mut places = [[0; 32]; 2];
    let mut sample = 0;
    while sample < 48 {
        let (pixel, band) = (sample / 3, sample % 3);
        let (group, number) = (pixel / 4, pixel % 4);
        let place = if by_bands {
            band / 2 * 32 + group * 8 + band % 2 * 4 + number
        } else {
            group / 2 * 32 + number * 8 + group % 2 * 4 + band
        };
        places[sample / 32][sample % 32] = place as i16;
        sample += 1;
    }
    places
}

/// Returns sixteen pixels of 16 bits, one behind the other.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) fn words<const C: usize, const N: usize>(&[a, b, c, d]: &[__m512i; 4]) -> [__m512i; 2] {
    let sign = _mm512_set1_epi16(i16::MIN);
    if C == 1 {
        let low = _mm512_castsi256_si512(_mm512_cvtsepi32_epi16(a));
        return [_mm512_xor_si512(low, sign), a];
    }
    let d = if is_by_bands(C, N) { c } else { d };
    let low = _mm512_xor_si512(_mm512_packs_epi32(a, b), sign);
    let high = _mm512_xor_si512(_mm512_packs_epi32(c, d), sign);
    if C != 3 {
        let order = _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7);
        return [
            _mm512_permutexvar_epi64(order, low),
            _mm512_permutexvar_epi64(order, high),
        ];
    }
    let [first, second] = const { &interleaved(is_by_bands(C, N)) };
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
pub(super) fn bytes<const C: usize, const N: usize>(&[a, b, c, d]: &[__m512i; 4]) -> __m512i {
    if C == 1 {
        let zero = _mm512_setzero_si512();
        return _mm512_castsi128_si512(_mm512_cvtusepi32_epi8(_mm512_max_epi32(a, zero)));
    }
    let d = if is_by_bands(C, N) { c } else { d };
    let (low, high) = (_mm512_packs_epi32(a, b), _mm512_packs_epi32(c, d));
    let pixels = _mm512_packus_epi16(low, high);
    let compact = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
    if is_by_bands(C, N) {
        let fours = _mm512_broadcast_i32x4(_mm_setr_epi8(
            0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7, 11, -1, -1, -1, -1,
        ));
        return _mm512_permutexvar_epi32(compact, _mm512_shuffle_epi8(pixels, fours));
    }
    let order = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
    let pixels = _mm512_permutexvar_epi32(order, pixels);
    if C != 3 {
        return pixels;
    }
    let of_three = _mm512_broadcast_i32x4(_mm_setr_epi8(
        0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1,
    ));
    _mm512_permutexvar_epi32(compact, _mm512_shuffle_epi8(pixels, of_three))
}
