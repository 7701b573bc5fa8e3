//! Rows of equidistant points, for warp engines.

use super::sensor::SensorPoint;

/// Points of the sensor frame from a first one on, along +x.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
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
