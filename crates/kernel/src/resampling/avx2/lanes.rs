//! Places and lanes of a run.

use core::arch::x86_64::*;

use crate::resampling::pixel::Places;

/// Samples of a load.
pub(super) const LOADED: usize = 8;

/// Values of a run, eight lanes each.
pub(super) type Values = [__m256i; 8];

/// Places of eight pixels, 1/2²⁴ px.
pub(super) struct Lanes {
    pub(super) col: __m256i,
    pub(super) row: __m256i,
}

impl Lanes {
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    pub(super) fn new(places: &Places, first: i32) -> Self {
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
pub(super) fn spread<const C: usize>(of_pixels: __m256i, pair: i32) -> __m256i {
    if C == 1 {
        return of_pixels;
    }
    let (a, b) = (2 * pair, 2 * pair + 1);
    _mm256_permutevar8x32_epi32(of_pixels, _mm256_setr_epi32(a, a, a, a, b, b, b, b))
}

/// Subtracts 2¹⁵ from samples of 16 bits.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
pub(super) fn centred(samples: __m256i) -> __m256i {
    _mm256_xor_si256(samples, _mm256_set1_epi16(i16::MIN))
}
