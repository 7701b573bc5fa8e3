//! Places and lanes of a run.

use core::arch::x86_64::*;

use super::group::is_by_bands;
use crate::resampling::pixel::Places;
use crate::resampling::run::PLACE_BITS;

/// Places of the sixteen pixels of a run.
pub(super) struct Lanes {
    /// Fractions of the bilinear kernel, or bits of which they are taken.
    pub(super) col: __m512i,
    pub(super) row: __m512i,
    /// Row from the base.
    pub(super) whole_row: __m512i,
    /// First tap in samples, in both halves of a lane: from that of the group's first pixel, or
    /// from the base if a group is all pixels.
    pub(super) samples: __m512i,
}

impl Lanes {
    #[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl")]
    #[inline]
    pub(super) fn new<const C: usize, const N: usize>(places: &Places) -> Self {
        let numbers = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
        let col_way = _mm512_mullo_epi32(numbers, _mm512_set1_epi32(places.col.step));
        let row_way = _mm512_mullo_epi32(numbers, _mm512_set1_epi32(places.row.step));
        let col = _mm512_add_epi32(_mm512_set1_epi32(places.col.start), col_way);
        let row = _mm512_add_epi32(_mm512_set1_epi32(places.row.start), row_way);
        let cols = _mm512_srai_epi32::<PLACE_BITS>(col);
        let samples = match C {
            1 => cols,
            3 => _mm512_add_epi32(cols, _mm512_add_epi32(cols, cols)),
            _ => _mm512_slli_epi32::<2>(cols),
        };
        let both = _mm512_or_si512(samples, _mm512_slli_epi32::<16>(samples));
        let firsts = if C == 1 {
            _mm512_setzero_si512()
        } else {
            _mm512_setr_epi32(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12)
        };
        let samples = if is_by_bands(C, N) {
            both
        } else {
            _mm512_sub_epi16(both, _mm512_permutexvar_epi32(firsts, both))
        };
        Self {
            col,
            row,
            whole_row: _mm512_srai_epi32::<PLACE_BITS>(row),
            samples,
        }
    }
}
