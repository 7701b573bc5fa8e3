//! Vertex of a mesh, as all formats store it.

/// A vertex: a pixel of the output image and the way to its place in the source image, the measured
/// one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Column of the output pixel, from the origin.
    pub col_px: i32,
    /// Row of the output pixel, from the origin.
    pub row_px: i32,
    /// Columns from there to its place in the source image, to the right.
    pub source_cols_px: f32,
    /// Rows from there to its place in the source image, downwards.
    pub source_rows_px: f32,
}

impl Vertex {
    /// Returns the place in the source image along an axis, from the origin, in single precision,
    /// pixels.
    #[expect(
        clippy::cast_precision_loss,
        reason = "exact: pixels of an image are fewer than 2^24"
    )]
    pub(super) fn source_px(&self, axis: PixelAxis) -> f32 {
        let (place_px, share_px) = self.along(axis);
        place_px as f32 + share_px
    }

    /// Returns the place of the output pixel along an axis and the way from there to the source,
    /// pixels.
    pub(super) const fn along(&self, axis: PixelAxis) -> (i32, f32) {
        match axis {
            PixelAxis::Columns => (self.col_px, self.source_cols_px),
            PixelAxis::Rows => (self.row_px, self.source_rows_px),
        }
    }
}

/// One of the two numbers of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PixelAxis {
    /// Along the row.
    Columns,
    /// Along the column.
    Rows,
}
