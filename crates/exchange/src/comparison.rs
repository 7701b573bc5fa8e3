//! Comparison of a program's camera with the calibrated one over the sensor.

use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::fit::GRID;
use crate::frames::Frame;
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

/// Returns the difference of measured points on the sensor of a frame, program's - camera's.
///
/// # Model
/// A point of the frame is seen where the calibrated camera has its distance from the principal
/// point divided by 1 + κ; the terms of μ₂ are left out.
#[must_use]
pub fn of_frame(camera: &Calibrated, frame: &Frame, program: &Pinhole) -> Residual {
    let [x0, y0] = camera.principal_point_mm;
    let [moved_x, moved_y] = frame.principal_point();
    Residual::of(camera.grid_mm(GRID).into_iter().map(|point| {
        let [at_x, at_y] = point;
        let scale = frame.scale();
        let at_rest = [x0 + (at_x - moved_x) / scale, y0 + (at_y - moved_y) / scale];
        let ray = camera.ray_from_measured(at_rest);
        let [x, y] = camera.sensor_from_pixel(program.pixel_from_ray(ray));
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
