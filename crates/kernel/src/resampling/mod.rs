//! Resampling of images on a PC: rows of output pixels whose places in a source image are given
//! run by run.
//!
//! The results have the same bits with every instruction set. Samples of 16 bits are reduced by
//! 2¹⁵, weights along a row have 14 bits and an exact sum, products are added in 32 bits. With two
//! taps the four weights of a pixel are products in 14 bits, and there is one rounding; with four
//! and six taps the sums of the rows are weighted in single precision, multiplied and added in one
//! order, none fused, and rounded once to even.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the instructions are enabled is compiled without them"
)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod band;
mod dispatch;
mod pixel;
mod portable;
mod run;
mod sample;
mod weights;

pub use band::Band;
pub use run::{PLACE_BITS, RUN_PX, Run};
pub use sample::Sample;
pub use weights::{FRACTIONS, MAX_TAPS, UNIT, weights};

use core::fmt;

use crate::host::Level;
use portable::Row;
use weights::Weights;

/// A kernel of resampling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// The nearest pixel; of two equally near ones the later.
    Nearest,
    /// Two taps, linear.
    Bilinear,
    /// Four taps: Keys 1981, a = -1/2.
    Bicubic,
    /// Six taps, fourth order: Keys 1981, eq. 25.
    Keys6,
    /// Six taps: sin(πx)·sin(πx/3)/(π²x²/3), normalised.
    Lanczos3,
}

impl Kernel {
    /// All kernels, by their number of taps.
    pub const ALL: [Self; 5] = [
        Self::Nearest,
        Self::Bilinear,
        Self::Bicubic,
        Self::Keys6,
        Self::Lanczos3,
    ];

    /// Name as options and reports have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Bilinear => "bilinear",
            Self::Bicubic => "bicubic",
            Self::Keys6 => "keys6",
            Self::Lanczos3 => "lanczos3",
        }
    }

    /// Taps along each axis.
    #[must_use]
    pub const fn taps(self) -> usize {
        match self {
            Self::Nearest => 1,
            Self::Bilinear => 2,
            Self::Bicubic => 4,
            Self::Keys6 | Self::Lanczos3 => 6,
        }
    }

    /// Taps after the place, along each axis: one fewer lie before the pixel at or before it. Zero
    /// for the nearest pixel.
    #[must_use]
    pub const fn half_taps(self) -> u8 {
        match self {
            Self::Nearest => 0,
            Self::Bilinear => 1,
            Self::Bicubic => 2,
            Self::Keys6 | Self::Lanczos3 => 3,
        }
    }

    /// Returns true for kernels that give a linear ramp back at any fraction of a pixel.
    #[must_use]
    pub const fn reproduces_ramp(self) -> bool {
        matches!(self, Self::Bilinear | Self::Bicubic | Self::Keys6)
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// Numbers of bands that are resampled.
pub const BANDS: [usize; 3] = [1, 3, 4];

/// A kernel, ready for rows of any image.
#[derive(Debug, Clone)]
pub struct Resampler {
    kernel: Kernel,
    level: Level,
    /// Tables of kernels with more than two taps.
    weights: Option<Weights>,
}

impl Resampler {
    /// Prepares a kernel with the widest vectors of this machine.
    #[must_use]
    pub fn new(kernel: Kernel) -> Self {
        let weights = (kernel.taps() > 2).then(|| Weights::new(kernel));
        Self {
            kernel,
            level: Level::widest(),
            weights,
        }
    }

    /// Selects other vectors.
    #[must_use]
    pub const fn at(mut self, level: Level) -> Self {
        self.level = level;
        self
    }

    /// Kernel in use.
    #[must_use]
    pub const fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Instruction set in use.
    #[must_use]
    pub const fn level(&self) -> Level {
        self.level
    }

    /// Writes a row of output pixels and their mask, 1 or 0 for border, and returns the number of
    /// border pixels.
    ///
    /// A place beyond the centre of an outermost pixel takes the value there up to half a pixel
    /// further; beyond that the pixel is border, and its samples are 0. Taps that reach over the
    /// edge take the edge's value. Pixels behind the last run are border.
    ///
    /// The band must hold every row of the taps; rows that it lacks count as 0.
    pub fn row<S: Sample>(
        &self,
        source: &Band<'_, S>,
        runs: &[Run],
        out: &mut [S],
        mask: &mut [u8],
    ) -> u32 {
        let row = Row {
            weights: self.weights.as_ref(),
            source,
            runs,
            out,
            mask,
        };
        dispatch::row(self.level, self.kernel.taps(), row)
    }
}
