//! A frame with the place of its principal point, to which its coordinates are referred.

use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::sensor::SensorPoint;

use crate::FrameRow;

/// The correction of a frame, and the shift that refers its coordinates to the calibration.
#[derive(Debug, Clone, Copy)]
pub struct PlacedFrame<'a> {
    /// Correction of its points.
    pub correction: GriddedCorrection<'a>,
    /// c̄·e: centroid principal point of the frame - the calibrated one, mm.
    pub shift_mm: [f64; 2],
    /// Calibrated principal point, mm.
    principal_point_mm: [f64; 2],
    /// 1 + κ.
    enlarged: f64,
    /// e, the FMC axis.
    pub axis: [f64; 2],
    /// σ of the principal point along the axis, mm.
    pub sigma_mm: Option<f64>,
    /// Formula that turned the focus shift into the enlargement.
    pub focus_sign: FocusSign,
}

impl<'a> PlacedFrame<'a> {
    /// Creates the frame; `None` for a refused trigger. `principal_point_mm` is the calibrated one
    /// as the camera file has it.
    #[must_use]
    pub fn new(
        row: &FrameRow,
        calibration: &Calibration,
        grids: &CameraGrids<'a>,
        principal_point_mm: [f64; 2],
    ) -> Option<Self> {
        let correction = row.correction(calibration)?;
        Self::with_correction(row, correction, calibration, grids, principal_point_mm)
    }

    /// Creates the frame with its correction, which was folded before: that of
    /// [`FrameRow::correction`].
    #[must_use]
    pub fn with_correction(
        row: &FrameRow,
        correction: FrameCorrection,
        calibration: &Calibration,
        grids: &CameraGrids<'a>,
        principal_point_mm: [f64; 2],
    ) -> Option<Self> {
        let correction = row.with_grids(correction, grids)?;
        let SensorPoint { x_mm, y_mm } = calibration
            .parameters()
            .axis
            .sensor_from_offset(SensorPoint::default(), 1.0);
        let axis = [x_mm, y_mm].map(f64::from);
        let centroid_mm = f64::from(row.motion.centroid_mm);
        Some(Self {
            correction,
            shift_mm: axis.map(|component| centroid_mm * component),
            principal_point_mm,
            enlarged: 1.0 + f64::from(row.enlargement),
            axis,
            sigma_mm: row.sigma().map(|sigma| f64::from(sigma.total_mm())),
            focus_sign: row.focus_sign(),
        })
    }

    /// Returns `true` if the frame's measured points can be referred to the calibration: with the
    /// printed signs of the focus shift, distortion does not scale with the image.
    #[must_use]
    pub fn has_shifted_points(&self) -> bool {
        self.focus_sign == FocusSign::Physical || self.enlarged.to_bits() == 1.0_f64.to_bits()
    }

    /// Returns the measured point about the calibrated principal point and at the calibrated
    /// principal distance.
    ///
    /// # Model
    /// `x0 + (x - c̄·e - x0)/(1 + κ)`: lens and distortion move together over the detector, and the
    /// focus shift enlarges the image with its distortion.
    #[must_use]
    pub fn shifted_from_measured(&self, point_mm: [f64; 2]) -> [f64; 2] {
        self.each(point_mm, |x, c, x0| x0 + (x - c - x0) / self.enlarged)
    }

    /// Returns the point of the sensor of one about the calibrated principal point: the inverse of
    /// [`Self::shifted_from_measured`].
    #[must_use]
    pub fn measured_from_shifted(&self, point_mm: [f64; 2]) -> [f64; 2] {
        self.each(point_mm, |x, c, x0| x0 + (x - x0) * self.enlarged + c)
    }

    /// Returns an ideal point about the calibrated principal point.
    #[must_use]
    pub fn shifted_from_ideal(&self, point_mm: [f64; 2]) -> [f64; 2] {
        self.each(point_mm, |x, c, _| x - c)
    }

    /// Returns an ideal point about the frame's own principal point.
    #[must_use]
    pub fn ideal_from_shifted(&self, point_mm: [f64; 2]) -> [f64; 2] {
        self.each(point_mm, |x, c, _| x + c)
    }

    /// 1 + κ.
    #[must_use]
    pub const fn enlarged(&self) -> f64 {
        self.enlarged
    }

    fn each(&self, [x, y]: [f64; 2], of: impl Fn(f64, f64, f64) -> f64) -> [f64; 2] {
        let ([cx, cy], [x0, y0]) = (self.shift_mm, self.principal_point_mm);
        [of(x, cx, x0), of(y, cy, y0)]
    }
}
