//! Fixed-point numbers of a vertex.

use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};
use crate::geometry::mesh::row_store::Span;

/// Number of steps that a 32-bit number holds.
const LARGEST_SHARE: f32 = 65_536.0 * 32_768.0;

/// A fixed-point number: a whole part that is exact and a share that is rounded to the nearest
/// step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fixed {
    pub(super) format: MeshFormat,
    pub(super) fraction_bits: u32,
    pub(super) min_px: f32,
    pub(super) max_px: f32,
}

impl Fixed {
    /// Returns `whole_px + share_px` in steps, or [`OutOfFormat`] if `Steps` cannot hold them.
    pub(super) fn steps<Steps: TryFrom<i64>>(
        &self,
        vertex: &Vertex,
        axis: PixelAxis,
    ) -> Result<Steps, OutOfFormat> {
        let (place_px, share_px) = vertex.along(axis);
        let is_displacement = self.format == MeshFormat::S16Q3;
        let whole_px = if is_displacement { 0 } else { place_px };
        let share = share_px * self.steps_per_px();
        // This excludes a NaN and numbers that the conversion would cut off.
        let rounded = (share.abs() < LARGEST_SHARE).then(|| i64::from(nearest(share)));
        let whole = i64::from(whole_px) << self.fraction_bits;
        rounded
            .and_then(|share| Steps::try_from(whole.saturating_add(share)).ok())
            .ok_or_else(|| {
                let value_px = if is_displacement {
                    share_px
                } else {
                    vertex.source_px(axis)
                };
                self.out_of_range(vertex, axis, value_px)
            })
    }

    fn out_of_range(&self, vertex: &Vertex, axis: PixelAxis, value_px: f32) -> OutOfFormat {
        OutOfFormat {
            format: self.format,
            col_px: vertex.col_px,
            row_px: vertex.row_px,
            axis,
            value_px,
            min_px: self.min_px,
            max_px: self.max_px,
        }
    }
}

impl Fixed {
    /// Returns steps per pixel.
    #[expect(clippy::cast_precision_loss, reason = "a power of two")]
    pub(super) const fn steps_per_px(&self) -> f32 {
        (1_i32 << self.fraction_bits) as f32
    }

    /// Returns true if all vertices of a span fit, whose displacements, in steps, differ from that
    /// of a node by at most `off_steps`.
    pub(super) fn holds(&self, span: &Span, nodes: &[[f32; 2]; 6], off_steps: f32) -> bool {
        let per_px = self.steps_per_px();
        let places = if self.format == MeshFormat::S16Q3 {
            [[0.0, 0.0]; 2]
        } else {
            span.ends_px()
        };
        // One step covers the roundings.
        let least = self.min_px * per_px + (off_steps + 1.0);
        let largest = self.max_px * per_px - (off_steps + 1.0);
        places.into_iter().all(|place| {
            nodes.iter().all(|node| {
                place.into_iter().zip(node).all(|(place_px, steps)| {
                    let source = place_px * per_px + steps;
                    source >= least && source <= largest
                })
            })
        })
    }

    /// Returns the vertex with a displacement in steps.
    pub(super) fn vertex(&self, [col_px, row_px]: [i32; 2], steps: [f32; 2]) -> Vertex {
        let px_per_step = 1.0 / self.steps_per_px();
        let [source_cols_px, source_rows_px] = steps.map(|steps| steps * px_per_step);
        Vertex {
            col_px,
            row_px,
            source_cols_px,
            source_rows_px,
        }
    }
}

/// Returns the nearest whole number, away from zero in the middle of two.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
pub(super) fn nearest(steps: f32) -> i32 {
    (steps + 0.5_f32.copysign(steps)) as i32
}

/// Returns the low half of the nearest whole number, the even one of two, for a number of at most
/// 2²²: the sum with 1.5·2²³ has no places behind the point.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "the low half")]
pub(super) const fn nearest16(steps: f32) -> u16 {
    (steps + 12_582_912.0).to_bits() as u16
}

/// Joins two numbers of two bytes.
pub(super) const fn pair16(columns: [u8; 2], rows: [u8; 2]) -> [u8; 4] {
    let ([c0, c1], [r0, r1]) = (columns, rows);
    [c0, c1, r0, r1]
}

/// Joins two numbers of four bytes.
pub(super) const fn pair32(columns: [u8; 4], rows: [u8; 4]) -> [u8; 8] {
    let ([c0, c1, c2, c3], [r0, r1, r2, r3]) = (columns, rows);
    [c0, c1, c2, c3, r0, r1, r2, r3]
}
