//! S16Q3: displacements of the mesh table of TI's lens distortion correction (LDC).
//!
//! The table has, in raster order, a 32-bit entry for every vertex: the horizontal and the vertical
//! displacement interleaved, each a signed 16-bit number in eighths of a pixel: source minus output
//! pixel (TI SPRUJB3, section "Mesh table" of LDC; TI E2E FAQ 1042074 has horizontal as the first).
//! Vertices lie every 2ᵐ pixels; the table begins on a 16-byte boundary.

use super::fixed::{Fixed, pair16};
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};

/// Half a step.
pub(super) const QUANTISATION_PX: f32 = 1.0 / 16.0;

const FIXED: Fixed = Fixed {
    format: MeshFormat::S16Q3,
    fraction_bits: 3,
    min_px: -4096.0,
    max_px: 4095.875,
};

/// The entry of a vertex.
///
/// # Errors
/// [`OutOfFormat`] for a displacement of more than 4096 pixels.
pub fn bytes(vertex: &Vertex) -> Result<[u8; 4], OutOfFormat> {
    let columns: i16 = FIXED.steps(vertex, PixelAxis::Columns)?;
    let rows: i16 = FIXED.steps(vertex, PixelAxis::Rows)?;
    Ok(pair16(columns.to_le_bytes(), rows.to_le_bytes()))
}
