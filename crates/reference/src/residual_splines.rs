//! Residual grids of a camera in double precision.

use fmc_camera::geometry::camera_grids::CameraGrids;

use crate::residual_spline::ResidualSpline;

/// Splines of the lens and of the sensor; those that a camera does not have are zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResidualSplines {
    lens: Option<ResidualSpline>,
    sensor: Option<ResidualSpline>,
}

impl ResidualSplines {
    /// Returns the splines of a camera's grids.
    #[must_use]
    pub fn of(grids: &CameraGrids<'_>) -> Self {
        Self {
            lens: grids.lens().map(ResidualSpline::of),
            sensor: grids.sensor().map(ResidualSpline::of),
        }
    }

    /// Returns true for a camera without residual grids.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.lens.is_none() && self.sensor.is_none()
    }

    /// Returns what the lens adds at a point of its own frame, mm.
    #[must_use]
    pub fn of_lens(&self, point_mm: [f64; 2]) -> [f64; 2] {
        at(self.lens.as_ref(), point_mm)
    }

    /// Returns what the sensor adds at a measured point, mm.
    #[must_use]
    pub fn of_sensor(&self, point_mm: [f64; 2]) -> [f64; 2] {
        at(self.sensor.as_ref(), point_mm)
    }

    /// Returns what both add with the stage at the calibrated position, mm.
    #[must_use]
    pub fn calibrated(&self, point_mm: [f64; 2]) -> [f64; 2] {
        let ([lens_x, lens_y], [x, y]) = (self.of_lens(point_mm), self.of_sensor(point_mm));
        [lens_x + x, lens_y + y]
    }
}

fn at(spline: Option<&ResidualSpline>, point_mm: [f64; 2]) -> [f64; 2] {
    spline.map_or([0.0; 2], |spline| spline.displacement(point_mm))
}
