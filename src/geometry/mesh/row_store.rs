//! Stores of a row's vertices, as differences fill them.

use super::format::{OutOfFormat, Vertex};
use crate::geometry::evaluation_form::Displacement;

/// Consecutive vertices of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// Column and row of the first from the origin, pixels.
    pub(super) place: [i32; 2],
    pub(super) spacing_px: u16,
    pub(super) count: usize,
}

impl Span {
    /// Returns the places of the first and the last vertex, pixels.
    #[expect(
        clippy::cast_precision_loss,
        reason = "exact: pixels of an image are fewer than 2^24"
    )]
    pub(super) fn ends_px(&self) -> [[f32; 2]; 2] {
        let [col_px, row_px] = self.place.map(|place_px| place_px as f32);
        let last = col_px + f32::from(self.spacing_px) * (self.count.saturating_sub(1)) as f32;
        [[col_px, row_px], [last, row_px]]
    }
}

/// Way to store the sources of a row's vertices.
pub(super) trait RowStore: Clone {
    /// A vertex as it is stored.
    type Word;

    /// Returns the format's steps per mm of the sensor frame, along x and y.
    fn steps_per_mm(&self) -> [f32; 2];

    /// Returns true if all vertices of a span fit the format, whose displacements, in steps, differ
    /// from that of a node by at most `off_steps`.
    fn holds(&self, span: &Span, nodes: &[[f32; 2]; 6], off_steps: f32) -> bool;

    /// Prepares [`Self::next`] for a span.
    fn begin(&mut self, span: &Span);

    /// Returns the next vertex of the span, from its displacement in steps.
    fn next(&mut self, steps: [f32; 2]) -> Self::Word;

    /// Returns a vertex that may not fit the format, from its displacement in steps.
    fn checked(&self, place: [i32; 2], steps: [f32; 2]) -> Result<Self::Word, OutOfFormat>;

    /// Returns a vertex that may not fit the format, from its displacement in mm.
    fn single(
        &self,
        place: [i32; 2],
        d: Displacement,
        pixel_mm: f32,
    ) -> Result<Self::Word, OutOfFormat>;
}

/// Returns a vertex with a displacement in the sensor frame, mm.
pub(super) fn vertex([col_px, row_px]: [i32; 2], d: Displacement, pixel_mm: f32) -> Vertex {
    Vertex {
        col_px,
        row_px,
        source_cols_px: d.dx_mm / pixel_mm,
        source_rows_px: -d.dy_mm / pixel_mm,
    }
}

/// Store of displacements in mm.
#[derive(Debug, Clone)]
pub(super) struct Millimetres;

impl RowStore for Millimetres {
    type Word = Displacement;

    fn steps_per_mm(&self) -> [f32; 2] {
        [1.0, 1.0]
    }

    fn holds(&self, _: &Span, _: &[[f32; 2]; 6], _: f32) -> bool {
        true
    }

    fn begin(&mut self, _: &Span) {}

    #[inline]
    fn next(&mut self, [dx_mm, dy_mm]: [f32; 2]) -> Displacement {
        Displacement { dx_mm, dy_mm }
    }

    fn checked(&self, _: [i32; 2], [dx_mm, dy_mm]: [f32; 2]) -> Result<Displacement, OutOfFormat> {
        Ok(Displacement { dx_mm, dy_mm })
    }

    fn single(&self, _: [i32; 2], d: Displacement, _: f32) -> Result<Displacement, OutOfFormat> {
        Ok(d)
    }
}
