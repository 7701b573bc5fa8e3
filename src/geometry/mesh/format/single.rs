//! Single precision: sources for NVIDIA VPI and for `remap` of `OpenCV` and Vitis Vision.
//!
//! VPI's warp map has control points of two floats, x then y (`VPIKeypointF32`), on the output
//! image's grid; `OpenCV` takes two maps of one float or one of two. All of them hold the place in
//! the source image.

use super::fixed::pair32;
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};

/// Returns the largest rounding of a coordinate of up to `largest_px` and of the displacement in
/// it: 0.0005 px at 10000 px.
#[must_use]
pub const fn quantisation_px(largest_px: f32) -> f32 {
    largest_px * (f32::EPSILON / 2.0)
}

/// Source column and row.
///
/// # Errors
/// [`OutOfFormat`] for a vertex that is not finite.
pub fn bytes(vertex: &Vertex) -> Result<[u8; 8], OutOfFormat> {
    let finite = |axis| {
        let value_px = vertex.source_px(axis);
        if value_px.is_finite() {
            Ok(value_px.to_le_bytes())
        } else {
            Err(OutOfFormat {
                format: MeshFormat::Single,
                col_px: vertex.col_px,
                row_px: vertex.row_px,
                axis,
                value_px,
                min_px: f32::MIN,
                max_px: f32::MAX,
            })
        }
    };
    let columns = finite(PixelAxis::Columns)?;
    let rows = finite(PixelAxis::Rows)?;
    Ok(pair32(columns, rows))
}
