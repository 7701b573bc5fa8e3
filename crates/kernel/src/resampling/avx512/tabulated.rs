//! Weights of four and six taps from their tables.

use core::arch::x86_64::*;

use super::lanes::Lanes;
use crate::resampling::pixel::Places;
use crate::resampling::run::PLACE_BITS;
use crate::resampling::weights::{ColumnWeights, FRACTION_BITS, FRACTIONS, RowWeights, Weights};

/// Weights from tables: of pairs of taps along rows, and of rows.
pub(super) struct Tabulated {
    pub(super) pairs: [__m512i; 3],
    pub(super) rows: [__m512; 6],
}

impl Tabulated {
    /// Returns the weights of the four pixels of a group, four lanes each.
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) fn of_group<const N: usize>(weights: &Weights, places: &Places, group: i32) -> Self {
        let [a, b, c, d] = [4 * group, 4 * group + 1, 4 * group + 2, 4 * group + 3];
        let along = |pixel: i32| weights.along(places.col.fraction::<N>(pixel));
        let pairs = _mm512_castsi128_si512(whole(along(a)));
        let pairs = _mm512_inserti32x4::<1>(pairs, whole(along(b)));
        let pairs = _mm512_inserti32x4::<2>(pairs, whole(along(c)));
        let pairs = _mm512_inserti32x4::<3>(pairs, whole(along(d)));
        let down = |pixel: i32| weights.down(places.row.fraction::<N>(pixel));
        let [a, b, c, d] = [down(a), down(b), down(c), down(d)];
        let low = _mm512_castps128_ps512(half(a, 0));
        let low = _mm512_insertf32x4::<1>(low, half(b, 0));
        let low = _mm512_insertf32x4::<2>(low, half(c, 0));
        let low = _mm512_insertf32x4::<3>(low, half(d, 0));
        let mut high = low;
        if N > 4 {
            high = _mm512_castps128_ps512(half(a, 1));
            high = _mm512_insertf32x4::<1>(high, half(b, 1));
            high = _mm512_insertf32x4::<2>(high, half(c, 1));
            high = _mm512_insertf32x4::<3>(high, half(d, 1));
        }
        Self {
            pairs: [
                _mm512_shuffle_epi32::<0b00_00_00_00>(pairs),
                _mm512_shuffle_epi32::<0b01_01_01_01>(pairs),
                _mm512_shuffle_epi32::<0b10_10_10_10>(pairs),
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
    pub(super) fn of_lanes<const N: usize>(weights: &Weights, lanes: &Lanes) -> Self {
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

/// Loads the weights of a row.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) fn whole(weights: &RowWeights) -> __m128i {
    // SAFETY: eight weights of 16 bits are borrowed.
    unsafe { _mm_loadu_si128(weights.as_ptr().cast()) }
}

/// Loads the first or the last four weights of a column.
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
#[inline]
pub(super) fn half(weights: &ColumnWeights, number: usize) -> __m128 {
    let halves = weights.as_chunks::<4>().0;
    let four = halves.get(number & 1).unwrap_or(&[0.0; 4]);
    // SAFETY: four weights of 32 bits are borrowed.
    unsafe { _mm_loadu_ps(four.as_ptr()) }
}
