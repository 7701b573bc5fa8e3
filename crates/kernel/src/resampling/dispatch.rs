//! Choice of the code for an instruction set, a number of taps and a number of bands.

use super::portable::{Plain, Row, Vectors};
use super::sample::Sample;
use crate::host::{Level, Token};

/// Resamples a row and returns the number of border pixels.
pub(super) fn row<S: Sample>(level: Level, taps: usize, row: Row<'_, S>) -> u32 {
    match level.token() {
        #[cfg(target_arch = "x86_64")]
        Token::Avx512(proof) => super::avx512::row(proof, taps, row),
        #[cfg(target_arch = "x86_64")]
        Token::Avx2(proof) => super::avx2::row(proof, taps, row),
        // Every aarch64 has NEON, so that the compiler uses it without being asked.
        #[cfg(target_arch = "aarch64")]
        Token::Neon(_) => by_size(Plain, taps, row),
        Token::Baseline => by_size(Plain, taps, row),
    }
}

/// Calls the code for a number of taps and bands.
#[inline(always)]
pub(super) fn by_size<S: Sample, V>(vectors: V, taps: usize, row: Row<'_, S>) -> u32
where
    V: Copy
        + Vectors<S, 1, 1>
        + Vectors<S, 3, 1>
        + Vectors<S, 4, 1>
        + Vectors<S, 1, 2>
        + Vectors<S, 3, 2>
        + Vectors<S, 4, 2>
        + Vectors<S, 1, 4>
        + Vectors<S, 3, 4>
        + Vectors<S, 4, 4>
        + Vectors<S, 1, 6>
        + Vectors<S, 3, 6>
        + Vectors<S, 4, 6>,
{
    match (taps, row.source.bands()) {
        (1, 1) => row.resample::<1, 1>(vectors),
        (1, 3) => row.resample::<3, 1>(vectors),
        (1, _) => row.resample::<4, 1>(vectors),
        (2, 1) => row.resample::<1, 2>(vectors),
        (2, 3) => row.resample::<3, 2>(vectors),
        (2, _) => row.resample::<4, 2>(vectors),
        (4, 1) => row.resample::<1, 4>(vectors),
        (4, 3) => row.resample::<3, 4>(vectors),
        (4, _) => row.resample::<4, 4>(vectors),
        (_, 1) => row.resample::<1, 6>(vectors),
        (_, 3) => row.resample::<3, 6>(vectors),
        (_, _) => row.resample::<4, 6>(vectors),
    }
}
