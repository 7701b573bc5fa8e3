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
mod by_size;
mod dispatch;
mod kernel;
#[cfg(target_arch = "aarch64")]
mod neon;
mod pixel;
mod portable;
mod run;
mod sample;
mod weights;

pub use band::{BANDS, Band};
pub use kernel::Kernel;
pub use run::{PLACE_BITS, RUN_PX, Run};
pub use sample::Sample;
pub use weights::{FRACTIONS, MAX_TAPS, UNIT, weights};

use crate::host::Level;
use portable::Row;
use weights::Weights;

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
