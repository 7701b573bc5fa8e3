//! Instruction sets of a host.

use core::fmt;

use pulp::Scalar;
#[cfg(target_arch = "aarch64")]
use pulp::aarch64::Neon;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};

use super::vectors::{Vectors as _, Work};

/// An instruction set that was found on this machine; one that the machine does not have cannot be
/// created.
#[derive(Debug, Clone, Copy)]
pub struct Level(Token);

/// Token of `pulp`, which proves that the instructions are present.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Token {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
    #[cfg(target_arch = "aarch64")]
    Neon(Neon),
}

impl Level {
    /// Instructions that every machine of the target has, vectorised by the compiler.
    pub const BASELINE: Self = Self(Token::Baseline);

    /// AVX2, if the machine has it.
    #[cfg(target_arch = "x86_64")]
    #[must_use]
    pub fn avx2() -> Option<Self> {
        V3::try_new().map(|token| Self(Token::Avx2(token)))
    }

    /// AVX-512 (F, BW, CD, DQ and VL), if the machine has it.
    #[cfg(target_arch = "x86_64")]
    #[must_use]
    pub fn avx512() -> Option<Self> {
        V4::try_new().map(|token| Self(Token::Avx512(token)))
    }

    /// NEON, if the machine has it.
    #[cfg(target_arch = "aarch64")]
    #[must_use]
    pub fn neon() -> Option<Self> {
        Neon::try_new().map(|token| Self(Token::Neon(token)))
    }

    /// Returns the instruction sets of this machine, the widest first.
    pub fn all() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let vectors = [Self::avx512(), Self::avx2()];
        #[cfg(target_arch = "aarch64")]
        let vectors = [Self::neon()];
        vectors.into_iter().flatten().chain([Self::BASELINE])
    }

    /// Returns the widest instruction set of this machine.
    #[must_use]
    pub fn widest() -> Self {
        Self::all().next().unwrap_or(Self::BASELINE)
    }

    /// Proof of the instructions.
    #[cfg(feature = "resampling")]
    pub(crate) const fn token(self) -> Token {
        self.0
    }

    pub(super) fn run(self, work: impl Work) {
        match self.0 {
            Token::Baseline => Scalar.run(work),
            #[cfg(target_arch = "x86_64")]
            Token::Avx2(vectors) => vectors.run(work),
            #[cfg(target_arch = "x86_64")]
            Token::Avx512(vectors) => vectors.run(work),
            #[cfg(target_arch = "aarch64")]
            Token::Neon(vectors) => vectors.run(work),
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self.0 {
            Token::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Token::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Token::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Token::Neon(_) => "neon",
        })
    }
}
