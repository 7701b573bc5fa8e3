//! S16Q3: displacements of the mesh table of TI's lens distortion correction (LDC).
//!
//! The table has, in raster order, a 32-bit entry for every vertex: the horizontal and the vertical
//! displacement interleaved, each a signed 16-bit number in eighths of a pixel: source minus output
//! pixel (TI SPRUJB3, section "Mesh table" of LDC; TI E2E FAQ 1042074 has horizontal as the first).
//! Vertices lie every 2ᵐ pixels; the table begins on a 16-byte boundary.

use super::fixed::{Fixed, nearest16, pair16};
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::mesh::row_store::{RowStore, Span, vertex};

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

/// Store of a row.
#[derive(Debug, Clone)]
pub(in crate::geometry::mesh) struct Store {
    steps_per_mm: [f32; 2],
}

impl Store {
    pub(in crate::geometry::mesh) fn new(pixels_per_mm: f32) -> Self {
        let steps = FIXED.steps_per_px() * pixels_per_mm;
        Self {
            steps_per_mm: [steps, -steps],
        }
    }
}

impl RowStore for Store {
    type Word = [u8; 4];

    fn steps_per_mm(&self) -> [f32; 2] {
        self.steps_per_mm
    }

    fn holds(&self, span: &Span, nodes: &[[f32; 2]; 6], off_steps: f32) -> bool {
        FIXED.holds(span, nodes, off_steps)
    }

    fn begin(&mut self, _: &Span) {}

    #[inline]
    fn next(&mut self, steps: [f32; 2]) -> [u8; 4] {
        let [columns, rows] = steps.map(nearest16);
        (u32::from(rows) << 16 | u32::from(columns)).to_le_bytes()
    }

    fn checked(&self, place: [i32; 2], steps: [f32; 2]) -> Result<[u8; 4], OutOfFormat> {
        bytes(&FIXED.vertex(place, steps))
    }

    fn single(
        &self,
        place: [i32; 2],
        d: Displacement,
        pixel_mm: f32,
    ) -> Result<[u8; 4], OutOfFormat> {
        bytes(&vertex(place, d, pixel_mm))
    }
}
