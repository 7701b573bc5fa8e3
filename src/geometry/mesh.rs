//! Rows of equidistant points, for warp engines.
//!
//! Two fields along a row are of use, and neither is the negative of the other:
//! - [`displacement_rows`]: at points of the *measured* image the distortion, measured - ideal,
//!   which leads from a measured pixel to its corrected place. It is computed by differences, in 13
//!   instructions per point. Graphics processors draw it; [`pixel_correction`] has it in pixels.
//! - [`source_row`]: at points of the *ideal* image the way to the measured point, which leads from
//!   an output pixel to its source. Warp engines read it; [`vertex`] has it in pixels and
//!   [`format`](mod@format) in the formats that they store.

mod differences;
pub mod displacement_rows;
pub mod format;
pub mod pixel_correction;
mod rounding_bound;
mod row_polynomial;
pub mod source_row;
pub mod vertex;

use super::sensor::SensorPoint;

/// Equidistant points of the sensor frame from a first one on, along +x.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshRow {
    /// The first point.
    pub first: SensorPoint,
    /// Distance from one point to the next along +x, mm.
    pub step_mm: f32,
    /// Number of points.
    pub count: u16,
}

impl MeshRow {
    /// Returns the points in order: `x = first + index·step`.
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
