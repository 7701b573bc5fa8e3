//! Choice of the code for an instruction set.

use super::by_size::by_size;
use super::portable::{Plain, Row};
use super::sample::Sample;
use crate::host::{Level, Token};

/// Resamples a row and returns the number of border pixels.
pub(super) fn row<S: Sample>(level: Level, taps: usize, row: Row<'_, S>) -> u32 {
    match level.token() {
        #[cfg(target_arch = "x86_64")]
        Token::Avx512(proof) => super::avx512::row(proof, taps, row),
        #[cfg(target_arch = "x86_64")]
        Token::Avx2(proof) => super::avx2::row(proof, taps, row),
        #[cfg(target_arch = "aarch64")]
        Token::Neon(proof) => super::neon::row(proof, taps, row),
        Token::Baseline => by_size(Plain, taps, row),
    }
}
