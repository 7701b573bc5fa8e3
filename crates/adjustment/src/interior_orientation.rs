//! Interior orientation, which all frames of a flight share.

use fmc_camera_file::CameraFile;
use fmc_reference::exposure::ExposurePath;

/// Principal distance and principal point of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InteriorOrientation {
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Calibrated principal point (x0, y0), about which the five coefficients are counted, mm.
    pub calibrated_point_mm: [f64; 2],
    /// Centroid principal point (x0, y0) + c̄·e, mm: that of the collinearity equations, and one of
    /// the pair of exposure means, whose other one is the centroid time.
    pub centroid_point_mm: [f64; 2],
    /// e: the direction in which the principal point moves.
    pub axis: [f64; 2],
    /// δ, mm.
    pub travel_mm: f64,
    /// c̄, mm.
    pub centroid_mm: f64,
    /// Half of the format, mm.
    pub half_format_mm: [f64; 2],
}

impl InteriorOrientation {
    /// Creates the interior orientation of an exposure of the camera.
    #[must_use]
    pub fn new(camera: &CameraFile, path: &ExposurePath) -> Self {
        let [x0, y0] = camera.principal_point_mm;
        let axis @ [ex, ey] = camera.fmc.axis.unit();
        let centroid_mm = path.centroid_mm();
        Self {
            principal_distance_mm: camera.principal_distance_mm,
            calibrated_point_mm: [x0, y0],
            centroid_point_mm: [x0 + centroid_mm * ex, y0 + centroid_mm * ey],
            axis,
            travel_mm: path.travel_mm,
            centroid_mm,
            half_format_mm: camera.half_format_mm(),
        }
    }

    /// ρ, the format radius: from the calibrated principal point to the farthest corner, mm.
    #[must_use]
    pub fn radius_mm(&self) -> f64 {
        let [x0, y0] = self.calibrated_point_mm;
        let [half_x, half_y] = self.half_format_mm;
        (half_x + x0.abs()).hypot(half_y + y0.abs())
    }

    /// Returns true if a measured point is on the sensor.
    #[must_use]
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let [half_x, half_y] = self.half_format_mm;
        x.abs() <= half_x && y.abs() <= half_y
    }

    /// Converts a point of the sensor frame into one from the principal point of the collinearity
    /// equations, mm.
    #[must_use]
    pub fn about_centroid(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [cx, cy] = self.centroid_point_mm;
        [x - cx, y - cy]
    }
}
