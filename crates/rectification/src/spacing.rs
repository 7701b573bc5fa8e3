//! Spacing of a mesh, from the bound of its error.

use fmc_camera::geometry::sensor::Sensor;

use crate::bound::SourceBounds;
use crate::fixed_point::VERTEX_BITS;
use crate::form::Form;

/// Largest error of a place by interpolation, pixels, that decides on the spacing.
pub const LARGEST_ERROR_PX: f64 = 0.001;

/// Largest distance of vertices, pixels.
pub const WIDEST_SPACING_PX: u32 = 256;

/// Largest stretch of the way from ideal to measured points.
pub const LARGEST_STRETCH: f64 = 3.5;

/// Rounding of a place in fixed point, pixels: of the vertices by half of 1/2²⁰ px, and of the
/// interpolation by a few 1/2²⁴ px, on both axes.
pub(crate) const ROUNDING_PX: f64 = 2.0 / (1 << VERTEX_BITS) as f64;

/// Share by which the stretch around the sensor may be above the one on it.
pub(crate) const STRETCH_AROUND: f64 = 1.5;

/// Returns the widest spacing whose error is within [`LARGEST_ERROR_PX`], with the bounds of the
/// map and the distance of a vertex from the sensor.
pub(crate) fn spacing(form: &Form, sensor: &Sensor) -> Option<(u32, SourceBounds, f64)> {
    let pixel_mm = f64::from(sensor.pixel_mm());
    let half_mm =
        [sensor.width_px(), sensor.height_px()].map(|side| 0.5 * f64::from(side) * pixel_mm);
    let on_sensor = SourceBounds::over(form, half_mm)?;
    let largest_stretch = on_sensor.stretch * STRETCH_AROUND;
    let mut spacing_px = WIDEST_SPACING_PX;
    while spacing_px > 0 {
        if error_px(&on_sensor, sensor, spacing_px) <= LARGEST_ERROR_PX {
            // The diagonal of a cell.
            let diagonal_mm = std::f64::consts::SQRT_2 * f64::from(spacing_px) * pixel_mm;
            let margin_mm = largest_stretch * diagonal_mm;
            let around = SourceBounds::over(form, half_mm.map(|half| half + margin_mm));
            if let Some(bounds) = around
                && bounds.stretch <= largest_stretch.min(LARGEST_STRETCH)
                && error_px(&bounds, sensor, spacing_px) <= LARGEST_ERROR_PX
            {
                return Some((spacing_px, bounds, margin_mm));
            }
        }
        spacing_px /= 2;
    }
    None
}

/// Returns the bound of a place's error, pixels.
pub(crate) fn error_px(bounds: &SourceBounds, sensor: &Sensor, spacing_px: u32) -> f64 {
    let [by_x, by_y] = bounds.second_per_mm;
    let spacing_px = f64::from(spacing_px);
    let of_lines = spacing_px * spacing_px / 8.0 * (by_x + by_y) * f64::from(sensor.pixel_mm());
    of_lines + ROUNDING_PX
}
