//! Comparison of a program's camera with the calibrated one over the sensor.

use crate::calibrated::{Calibrated, GRID};
use crate::correction::Correction;
use crate::pinhole::Pinhole;
use crate::residual::Residual;

/// Returns the difference of measured points, program's - camera's, for the strict rays of the
/// whole sensor.
#[must_use]
pub fn measured(camera: &Calibrated, program: &Pinhole) -> Residual {
    Residual::of(camera.grid_mm(GRID).into_iter().map(|point| {
        let ray = camera.ray_from_measured(point);
        let [x, y] = camera.sensor_from_pixel(program.pixel_from_ray(ray));
        let [at_x, at_y] = point;
        (point, [x - at_x, y - at_y])
    }))
}

/// Returns the difference of ideal points, program's - camera's, at the principal distance of the
/// program, over the whole sensor.
#[must_use]
pub fn ideal(camera: &Calibrated, program: &Correction) -> Residual {
    let distance = program.principal_distance_mm;
    Residual::of(camera.grid_mm(GRID).into_iter().map(|point| {
        let [x, y] = program.ray_from_measured(point);
        let [strict_x, strict_y] = camera.ray_from_measured(point);
        (
            point,
            [(x - strict_x) * distance, (strict_y - y) * distance],
        )
    }))
}
