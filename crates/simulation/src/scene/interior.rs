//! Interior orientation: the calibrated principal point and the sensor's orientation behind the
//! lens.

use fmc_camera_file::{Axis, CameraFile};

/// Interior orientation of the camera with its stage at the calibrated position.
#[derive(Debug, Clone, PartialEq)]
pub struct InteriorOrientation {
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// L, exit pupil to image, mm.
    pub exit_pupil_mm: f64,
    /// Calibrated principal point (x0, y0), mm.
    pub principal_point_mm: [f64; 2],
    /// Direction of flight in the sensor frame.
    pub axis: Axis,
    /// Half of width and height of the pixel array, mm.
    pub half_format_mm: [f64; 2],
}

impl InteriorOrientation {
    /// Returns the interior orientation of a camera file.
    #[must_use]
    pub fn of(camera: &CameraFile) -> Self {
        Self {
            principal_distance_mm: camera.principal_distance_mm,
            exit_pupil_mm: camera.exit_pupil_mm(),
            principal_point_mm: camera.principal_point_mm,
            axis: camera.fmc.axis,
            half_format_mm: camera.half_format_mm(),
        }
    }

    /// Converts components along right and forward into those of the sensor frame.
    #[must_use]
    pub const fn sensor_from_camera(&self, [right, forward]: [f64; 2]) -> [f64; 2] {
        let [ex, ey] = self.axis.unit();
        [ey * right + ex * forward, ey * forward - ex * right]
    }

    /// Converts components of the sensor frame into those along right and forward.
    #[must_use]
    pub const fn camera_from_sensor(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [ex, ey] = self.axis.unit();
        [ey * x - ex * y, ex * x + ey * y]
    }

    /// Returns true if a point of the sensor frame lies on the pixel array, edges included.
    #[must_use]
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let [half_x, half_y] = self.half_format_mm;
        x.abs() <= half_x && y.abs() <= half_y
    }
}
