//! UQ12.4: vertices of the dewarp engine DW100 of NXP's i.MX 8M Plus.
//!
//! A vertex lies every 16 pixels, the last row and column at or beyond the image's end. Each is a
//! 32-bit word with the source column in its low half and the source row in its high half, both
//! unsigned in sixteenths of a pixel (Linux driver `dw100`, control
//! `V4L2_CID_DW100_DEWARPING_16x16_VERTEX_MAP`). The engine takes images of at most 4096 x 3072
//! pixels: a larger sensor is corrected part by part.

use super::fixed::{Fixed, pair16};
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};

/// Half a step.
pub(super) const QUANTISATION_PX: f32 = 1.0 / 32.0;

/// Number of pixels from one vertex to the next.
pub const SPACING_PX: u16 = 16;

const FIXED: Fixed = Fixed {
    format: MeshFormat::Uq12Q4,
    fraction_bits: 4,
    min_px: 0.0,
    max_px: 4095.9375,
};

/// The word of a vertex.
///
/// # Errors
/// [`OutOfFormat`] for a source before the origin, or 4096 pixels or more from it.
pub fn bytes(vertex: &Vertex) -> Result<[u8; 4], OutOfFormat> {
    let columns: u16 = FIXED.steps(vertex, PixelAxis::Columns)?;
    let rows: u16 = FIXED.steps(vertex, PixelAxis::Rows)?;
    Ok(pair16(columns.to_le_bytes(), rows.to_le_bytes()))
}
