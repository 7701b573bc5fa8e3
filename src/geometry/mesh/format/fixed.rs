//! Fixed-point numbers of a vertex.

use super::mesh_format::{MeshFormat, OutOfFormat};
use super::vertex::{PixelAxis, Vertex};

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
        let steps_per_px = 1_i32 << self.fraction_bits;
        #[expect(clippy::cast_precision_loss, reason = "a power of two")]
        let share = share_px * steps_per_px as f32;
        // This excludes a NaN and numbers that the conversion would cut off.
        let rounded = (share.abs() < LARGEST_SHARE).then(|| {
            #[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
            let nearest = (share + 0.5_f32.copysign(share)) as i32;
            i64::from(nearest)
        });
        let whole = i64::from(whole_px) * i64::from(steps_per_px);
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
