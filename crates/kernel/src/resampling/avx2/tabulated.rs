//! Weights of four and six taps from their tables.

use core::arch::x86_64::*;

use super::lanes::Lanes;
use crate::resampling::pixel::Places;
use crate::resampling::run::PLACE_BITS;
use crate::resampling::weights::{ColumnWeights, FRACTION_BITS, FRACTIONS, RowWeights, Weights};

/// Weights from tables: of pairs of taps along rows, and of rows.
pub(super) struct Tabulated {
    pub(super) pairs: [__m256i; 3],
    pub(super) rows: [__m256; 6],
}

impl Tabulated {
    /// Returns the weights of two pixels, four lanes each.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    #[inline]
    pub(super) fn of_pair<const N: usize>(weights: &Weights, places: &Places, pixel: i32) -> Self {
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
    pub(super) fn of_lanes<const N: usize>(weights: &Weights, lanes: &Lanes) -> Self {
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
pub(super) fn whole(weights: &RowWeights) -> __m128i {
    // SAFETY: eight weights of 16 bits are borrowed.
    unsafe { _mm_loadu_si128(weights.as_ptr().cast()) }
}

/// Loads the first or the last four weights of a column.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline]
pub(super) fn half(weights: &ColumnWeights, number: usize) -> __m128 {
    let halves = weights.as_chunks::<4>().0;
    let four = halves.get(number & 1).unwrap_or(&[0.0; 4]);
    // SAFETY: four weights of 32 bits are borrowed.
    unsafe { _mm_loadu_ps(four.as_ptr()) }
}
