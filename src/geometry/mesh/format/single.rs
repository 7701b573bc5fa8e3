//! Single precision: sources for NVIDIA VPI and for `remap` of `OpenCV` and Vitis Vision.
//!
//! VPI's warp map has control points of two floats, x then y (`VPIKeypointF32`), on the output
//! image's grid; `OpenCV` takes two maps of one float or one of two. All of them hold the place in
//! the source image.

use super::fixed::pair32;
use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::mesh::row_store::{RowStore, Span, vertex};

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

/// Store of a row; a step is a pixel.
#[derive(Debug, Clone)]
pub(in crate::geometry::mesh) struct Store {
    pixels_per_mm: f32,
    /// Place of the next vertex and the way to the one behind it, pixels.
    place: [f32; 2],
    spacing: f32,
}

impl Store {
    pub(in crate::geometry::mesh) const fn new(pixels_per_mm: f32) -> Self {
        Self {
            pixels_per_mm,
            place: [0.0, 0.0],
            spacing: 0.0,
        }
    }
}

impl RowStore for Store {
    type Word = [u8; 8];

    fn steps_per_mm(&self) -> [f32; 2] {
        [self.pixels_per_mm, -self.pixels_per_mm]
    }

    fn holds(&self, _: &Span, nodes: &[[f32; 2]; 6], _: f32) -> bool {
        nodes.as_flattened().iter().all(|steps| steps.is_finite())
    }

    fn begin(&mut self, span: &Span) {
        let [first, _] = span.ends_px();
        self.place = first;
        self.spacing = f32::from(span.spacing_px);
    }

    #[inline]
    fn next(&mut self, [columns, rows]: [f32; 2]) -> [u8; 8] {
        let [place_columns, place_rows] = self.place;
        // Whole numbers, exact.
        self.place = [place_columns + self.spacing, place_rows];
        let source = [place_columns + columns, place_rows + rows];
        let [columns, rows] = source.map(f32::to_le_bytes);
        pair32(columns, rows)
    }

    fn checked(
        &self,
        [col_px, row_px]: [i32; 2],
        [source_cols_px, source_rows_px]: [f32; 2],
    ) -> Result<[u8; 8], OutOfFormat> {
        bytes(&Vertex {
            col_px,
            row_px,
            source_cols_px,
            source_rows_px,
        })
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
