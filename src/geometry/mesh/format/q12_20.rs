//! Q12.20: sources in the fixed-point type of Vitis Vision's rectification, `ap_fixed<32, 12>`.
//!
//! The number has 12 bits with the sign before the point and 20 after it. Vitis Vision uses the
//! type for the parameters of `InitUndistortRectifyMapInverse`; its own `remap` reads maps in
//! single precision ([`super::single`]). This format is for kernels that stay in fixed point.

use super::fixed::{Fixed, nearest, pair32};
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::mesh::row_store::{RowStore, Span, vertex};

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

/// Store of a row.
#[derive(Debug, Clone)]
pub(in crate::geometry::mesh) struct Store {
    steps_per_mm: [f32; 2],
    /// Place of the next vertex and the way to the one behind it, steps.
    place: [i32; 2],
    spacing: i32,
}

impl Store {
    pub(in crate::geometry::mesh) fn new(pixels_per_mm: f32) -> Self {
        let steps = FIXED.steps_per_px() * pixels_per_mm;
        Self {
            steps_per_mm: [steps, -steps],
            place: [0, 0],
            spacing: 0,
        }
    }
}

impl RowStore for Store {
    type Word = [u8; 8];

    fn steps_per_mm(&self) -> [f32; 2] {
        self.steps_per_mm
    }

    fn holds(&self, span: &Span, nodes: &[[f32; 2]; 6], off_steps: f32) -> bool {
        FIXED.holds(span, nodes, off_steps)
    }

    fn begin(&mut self, span: &Span) {
        // Sums and products go round at 2³², where a source that fits does not.
        self.place = span.place.map(|place_px| place_px << FIXED.fraction_bits);
        self.spacing = i32::from(span.spacing_px) << FIXED.fraction_bits;
    }

    #[inline]
    fn next(&mut self, steps: [f32; 2]) -> [u8; 8] {
        let [place_columns, place_rows] = self.place;
        let [columns, rows] = steps.map(nearest);
        self.place = [place_columns.wrapping_add(self.spacing), place_rows];
        let columns = place_columns.wrapping_add(columns);
        let rows = place_rows.wrapping_add(rows);
        pair32(columns.to_le_bytes(), rows.to_le_bytes())
    }

    fn checked(&self, place: [i32; 2], steps: [f32; 2]) -> Result<[u8; 8], OutOfFormat> {
        bytes(&FIXED.vertex(place, steps))
    }

    fn single(
        &self,
        place: [i32; 2],
        d: Displacement,
        pixel_mm: f32,
    ) -> Result<[u8; 8], OutOfFormat> {
        bytes(&vertex(place, d, pixel_mm))
    }
}
