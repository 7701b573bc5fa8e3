//! Kernels of resampling.

use core::fmt;

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
