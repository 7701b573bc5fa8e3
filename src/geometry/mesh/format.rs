//! Formats in which warp engines store numbers.
//!
//! | format | a vertex | range | step | engines |
//! |---|---|---|---|---|
//! | [`s16q3`] | displacement | -4096 to 4095.875 px | 1/8 px | TI LDC |
//! | [`uq12_4`] | source | 0 to 4095.9375 px | 1/16 px | `DeWarp` DW100 of NXP i.MX 8M Plus |
//! | [`q12_20`] | source | -2048 to 2048 px | 2⁻²⁰ px | `ap_fixed<32, 12>` of Vitis Vision |
//! | [`single`] | source | any image | 2⁻²⁴ of it | NVIDIA VPI, `remap` of `OpenCV`, Vitis Vision |
//!
//! Columns come before rows, and all are little endian. Pixels are those of the project: the
//! centre of the first one is (0, 0).

mod fixed;
mod mesh_format;
pub mod q12_20;
pub mod s16q3;
pub mod single;
pub mod uq12_4;
mod vertex;

pub use mesh_format::{MeshFormat, OutOfFormat};
pub use vertex::{PixelAxis, Vertex};

use heapless::Vec;

/// Largest number of bytes of a vertex.
pub const MAX_WORD_BYTES: usize = 8;

/// The bytes of one vertex.
pub type Word = Vec<u8, MAX_WORD_BYTES>;

impl MeshFormat {
    /// Returns the largest difference between the stored number and the vertex's, pixels per axis,
    /// for a coordinate of up to `largest_px`.
    #[must_use]
    pub const fn quantisation_px(self, largest_px: f32) -> f32 {
        match self {
            Self::S16Q3 => s16q3::QUANTISATION_PX,
            Self::Uq12Q4 => uq12_4::QUANTISATION_PX,
            Self::Q12Q20 => q12_20::QUANTISATION_PX,
            Self::Single => single::quantisation_px(largest_px),
        }
    }

    /// Returns a vertex as it is stored.
    ///
    /// # Errors
    /// [`OutOfFormat`] for a number beyond the format's range.
    pub fn word(self, vertex: &Vertex) -> Result<Word, OutOfFormat> {
        // A word has room for the bytes of every format.
        let word = |bytes: &[u8]| Word::from_slice(bytes).unwrap_or_default();
        Ok(match self {
            Self::S16Q3 => word(&s16q3::bytes(vertex)?),
            Self::Uq12Q4 => word(&uq12_4::bytes(vertex)?),
            Self::Q12Q20 => word(&q12_20::bytes(vertex)?),
            Self::Single => word(&single::bytes(vertex)?),
        })
    }
}
