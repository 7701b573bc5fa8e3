//! Q12.20: sources in the fixed-point type of Vitis Vision's rectification, `ap_fixed<32, 12>`.
//!
//! The number has 12 bits with the sign before the point and 20 after it. Vitis Vision uses the
//! type for the parameters of `InitUndistortRectifyMapInverse`; its own `remap` reads maps in
//! single precision ([`super::single`]). This format is for kernels that stay in fixed point.

use super::fixed::{Fixed, pair32};
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};

/// Half a step, plus the rounding, before that, of a displacement of up to 256 pixels.
pub(super) const QUANTISATION_PX: f32 = 0.5 / 1_048_576.0 + 256.0 * f32::EPSILON;

const FIXED: Fixed = Fixed {
    format: MeshFormat::Q12Q20,
    fraction_bits: 20,
    min_px: -2048.0,
    max_px: 2048.0 - 1.0 / 8192.0,
};

/// Source column and row.
///
/// # Errors
/// [`OutOfFormat`] for a source 2048 pixels or more from the origin.
pub fn bytes(vertex: &Vertex) -> Result<[u8; 8], OutOfFormat> {
    let columns: i32 = FIXED.steps(vertex, PixelAxis::Columns)?;
    let rows: i32 = FIXED.steps(vertex, PixelAxis::Rows)?;
    Ok(pair32(columns.to_le_bytes(), rows.to_le_bytes()))
}
