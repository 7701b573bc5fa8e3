//! The vertex formats, and the error of a number beyond their range.

use core::fmt;

use super::vertex::PixelAxis;

/// Format in which a warp engine stores a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum MeshFormat {
    /// Displacements in eighths of a pixel: [`s16q3`](super::s16q3).
    S16Q3,
    /// Sources in sixteenths of a pixel: [`uq12_4`](super::uq12_4).
    Uq12Q4,
    /// Sources in millionths of a pixel: [`q12_20`](super::q12_20).
    Q12Q20,
    /// Sources in single precision: [`single`](super::single).
    Single,
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::S16Q3, Self::Uq12Q4, Self::Q12Q20, Self::Single];

    /// Number of bytes of one vertex.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::S16Q3 | Self::Uq12Q4 => 4,
            Self::Q12Q20 | Self::Single => 8,
        }
    }
}

/// A number of a vertex is beyond its format's range.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OutOfFormat {
    /// The format.
    pub format: MeshFormat,
    /// Column of the vertex, from the origin.
    pub col_px: i32,
    /// Row of the vertex, from the origin.
    pub row_px: i32,
    /// The number of the vertex that is out of range.
    pub axis: PixelAxis,
    /// Its value, pixels.
    pub value_px: f32,
    /// Smallest value that fits.
    pub min_px: f32,
    /// Largest value that fits.
    pub max_px: f32,
}

impl fmt::Display for OutOfFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match (self.format, self.axis) {
            (MeshFormat::S16Q3, PixelAxis::Columns) => "displacement along the row",
            (MeshFormat::S16Q3, PixelAxis::Rows) => "displacement along the column",
            (_, PixelAxis::Columns) => "source column",
            (_, PixelAxis::Rows) => "source row",
        };
        write!(
            f,
            "the vertex at column {}, row {} from the origin has a {what} of {} px, and the format holds {} to {} px",
            self.col_px, self.row_px, self.value_px, self.min_px, self.max_px
        )
    }
}

impl core::error::Error for OutOfFormat {}
