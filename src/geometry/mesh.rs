//! Rows of equidistant points, for warp engines.
//!
//! Two fields along a row are of use, and they are not each other's negative:
//! - [`displacement_rows`]: at points of the *measured* image the distortion, measured - ideal: where a
//!   measured pixel is to go. By differences, 13 instructions per point. This is what graphics processors draw;
//!   [`pixel_correction`] has it in pixels.
//! - [`source_row`]: at points of the *ideal* image the way to the measured point: where an output pixel comes
//!   from. This is what warp engines read; [`vertex`] has it in pixels and [`format`](mod@format) as they store it.

mod differences;
pub mod displacement_rows;
pub mod format;
pub mod pixel_correction;
mod rounding_bound;
mod row_polynomial;
pub mod source_row;
pub mod vertex;

use super::sensor::SensorPoint;

/// Points of the sensor frame from a first one on, along +x.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshRow {
    /// The first point.
    pub first: SensorPoint,
    /// From one point to the next along +x, mm.
    pub step_mm: f32,
    /// How many points.
    pub count: u16,
}

impl MeshRow {
    /// The points, in order: `x = first + index·step`.
    pub fn points(&self) -> impl Iterator<Item = SensorPoint> + use<> {
        let Self {
            first,
            step_mm,
            count,
        } = *self;
        (0..count)
            .map(move |index| SensorPoint::new(first.x_mm + f32::from(index) * step_mm, first.y_mm))
    }
}
