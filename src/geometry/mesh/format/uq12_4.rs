//! UQ12.4: vertices of the dewarp engine DW100 of NXP's i.MX 8M Plus.
//!
//! A vertex lies every 16 pixels, the last row and column at or beyond the image's end. Each is a
//! 32-bit word with the source column in its low half and the source row in its high half, both
//! unsigned in sixteenths of a pixel (Linux driver `dw100`, control
//! `V4L2_CID_DW100_DEWARPING_16x16_VERTEX_MAP`). The engine takes images of at most 4096 x 3072
//! pixels: a larger sensor is corrected part by part.

use super::fixed::{Fixed, nearest16, pair16};
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::mesh::row_store::{RowStore, Span, vertex};

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

/// Store of a row.
#[derive(Debug, Clone)]
pub(in crate::geometry::mesh) struct Store {
    steps_per_mm: [f32; 2],
    /// Place of the next vertex and the way to the one behind it, steps.
    place: [u16; 2],
    spacing: u16,
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
    type Word = [u8; 4];

    fn steps_per_mm(&self) -> [f32; 2] {
        self.steps_per_mm
    }

    fn holds(&self, span: &Span, nodes: &[[f32; 2]; 6], off_steps: f32) -> bool {
        FIXED.holds(span, nodes, off_steps)
    }

    fn begin(&mut self, span: &Span) {
        // Sums and products go round at 2¹⁶, where a source that fits does not.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the low half"
        )]
        let low = |place_px: i32| (place_px as u16) << FIXED.fraction_bits;
        self.place = span.place.map(low);
        self.spacing = span.spacing_px << FIXED.fraction_bits;
    }

    #[inline]
    fn next(&mut self, steps: [f32; 2]) -> [u8; 4] {
        let [place_columns, place_rows] = self.place;
        let [columns, rows] = steps.map(nearest16);
        self.place = [place_columns.wrapping_add(self.spacing), place_rows];
        let columns = u32::from(place_columns.wrapping_add(columns));
        let rows = u32::from(place_rows.wrapping_add(rows));
        (rows << 16 | columns).to_le_bytes()
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
