//! Numbers as warp engines store them.
//!
//! | format | a vertex | range | step | engines |
//! |---|---|---|---|---|
//! | [`s16q3`] | displacement, columns then rows | -4096 to 4095.875 px | 1/8 px | TI LDC |
//! | [`uq12_4`] | source, columns then rows | 0 to 4095.9375 px | 1/16 px | `DeWarp` engine DW100 of NXP i.MX 8M Plus |
//! | [`q12_20`] | source, columns then rows | -2048 to 2048 px | 2⁻²⁰ px | `ap_fixed<32, 12>` of Vitis Vision |
//! | [`single`] | source, columns then rows | every one of an image | 2⁻²⁴ of it | NVIDIA VPI, `remap` of `OpenCV` and Vitis Vision |
//!
//! All are little endian. The pixel convention is the project's: the centre of the first pixel is (0, 0).

pub mod q12_20;
pub mod s16q3;
pub mod single;
pub mod uq12_4;

use core::fmt;

use heapless::Vec;

use super::vertex::Vertex;

/// Most bytes of a vertex.
pub const MAX_WORD_BYTES: usize = 8;

/// The bytes of one vertex.
pub type Word = Vec<u8, MAX_WORD_BYTES>;

/// How a warp engine stores a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum MeshFormat {
    /// Displacements in eighths of a pixel: [`s16q3`].
    S16Q3,
    /// Sources in sixteenths of a pixel: [`uq12_4`].
    Uq12Q4,
    /// Sources in millionths of a pixel: [`q12_20`].
    Q12Q20,
    /// Sources in single precision: [`single`].
    Single,
}

impl MeshFormat {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::S16Q3, Self::Uq12Q4, Self::Q12Q20, Self::Single];

    /// Bytes of one vertex.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::S16Q3 | Self::Uq12Q4 => 4,
            Self::Q12Q20 | Self::Single => 8,
        }
    }

    /// Largest difference of the stored number to the vertex's, pixels per axis, for a coordinate of up to `largest_px`.
    #[must_use]
    pub const fn quantisation_px(self, largest_px: f32) -> f32 {
        match self {
            Self::S16Q3 => s16q3::QUANTISATION_PX,
            Self::Uq12Q4 => uq12_4::QUANTISATION_PX,
            Self::Q12Q20 => q12_20::QUANTISATION_PX,
            Self::Single => single::quantisation_px(largest_px),
        }
    }

    /// A vertex as it is stored.
    ///
    /// # Errors
    /// [`OutOfFormat`] for a number beyond the format's range.
    pub fn word(self, vertex: &Vertex) -> Result<Word, OutOfFormat> {
        // No format has more bytes than a word.
        let word = |bytes: &[u8]| Word::from_slice(bytes).unwrap_or_default();
        Ok(match self {
            Self::S16Q3 => word(&s16q3::bytes(vertex)?),
            Self::Uq12Q4 => word(&uq12_4::bytes(vertex)?),
            Self::Q12Q20 => word(&q12_20::bytes(vertex)?),
            Self::Single => word(&single::bytes(vertex)?),
        })
    }
}

/// Which of the two numbers of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum PixelAxis {
    /// Along the row.
    Columns,
    /// Along the column.
    Rows,
}

/// A number of a vertex is beyond its format's range.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct OutOfFormat {
    /// Which format.
    pub format: MeshFormat,
    /// Column of the vertex, from the origin.
    pub col_px: i32,
    /// Its row.
    pub row_px: i32,
    /// Which of its two numbers.
    pub axis: PixelAxis,
    /// The number, pixels.
    pub value_px: f32,
    /// Smallest that fits.
    pub min_px: f32,
    /// Largest that fits.
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

/// Steps that a 32-bit number holds.
const LARGEST_SHARE: f32 = 65_536.0 * 32_768.0;

/// A fixed-point number: a whole part that is counted exactly and a share that is rounded to the nearest step.
#[derive(Debug, Clone, Copy)]
struct Fixed {
    format: MeshFormat,
    fraction_bits: u32,
    min_px: f32,
    max_px: f32,
}

impl Fixed {
    /// Steps of `whole_px + share_px`; [`OutOfFormat`] where `Steps` cannot hold them.
    fn steps<Steps: TryFrom<i64>>(
        &self,
        vertex: &Vertex,
        axis: PixelAxis,
    ) -> Result<Steps, OutOfFormat> {
        let (place_px, share_px) = match axis {
            PixelAxis::Columns => (vertex.col_px, vertex.source_cols_px),
            PixelAxis::Rows => (vertex.row_px, vertex.source_rows_px),
        };
        let whole_px = if self.format == MeshFormat::S16Q3 {
            0
        } else {
            place_px
        };
        let steps_per_px = 1_i32 << self.fraction_bits;
        #[expect(clippy::cast_precision_loss, reason = "a power of two")]
        let share = share_px * steps_per_px as f32;
        // Neither a NaN nor a number that the conversion would cut off.
        let rounded = (share.abs() < LARGEST_SHARE).then(|| {
            #[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
            let nearest = (share + 0.5_f32.copysign(share)) as i32;
            i64::from(nearest)
        });
        let whole = i64::from(whole_px) * i64::from(steps_per_px);
        rounded
            .and_then(|share| Steps::try_from(whole.saturating_add(share)).ok())
            .ok_or_else(|| self.out_of_range(vertex, axis, single::sum(whole_px, share_px)))
    }

    fn out_of_range(&self, vertex: &Vertex, axis: PixelAxis, value_px: f32) -> OutOfFormat {
        OutOfFormat {
            format: self.format,
            col_px: vertex.col_px,
            row_px: vertex.row_px,
            axis,
            value_px,
            min_px: self.min_px,
            max_px: self.max_px,
        }
    }
}

/// The bytes of two numbers of two bytes.
const fn pair16(columns: [u8; 2], rows: [u8; 2]) -> [u8; 4] {
    let ([c0, c1], [r0, r1]) = (columns, rows);
    [c0, c1, r0, r1]
}

/// The bytes of two numbers of four bytes.
const fn pair32(columns: [u8; 4], rows: [u8; 4]) -> [u8; 8] {
    let ([c0, c1, c2, c3], [r0, r1, r2, r3]) = (columns, rows);
    [c0, c1, c2, c3, r0, r1, r2, r3]
}
