//! Points in millimetres of the sensor frame and in pixels.

use fmc_camera_file::CameraFile;

use crate::coordinate::Coordinate;

/// Unit of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Sensor frame, mm.
    Millimetres,
    /// Column and row; the centre of the first pixel is (0, 0), rows go down.
    Pixels,
}

impl Unit {
    /// Returns a point in mm.
    pub(crate) fn millimetres<T: Coordinate>(self, file: &CameraFile, point: [T; 2]) -> [f64; 2] {
        let point = point.map(T::double);
        match self {
            Self::Millimetres => point,
            Self::Pixels => file.sensor_from_pixel(point),
        }
    }
}
