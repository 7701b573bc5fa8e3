//! One frame of a flight.

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::principal_distance::{FocusShift, FocusSign};
use fmc_camera::geometry::principal_point::PrincipalPointMotion;

/// A trigger of the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightFrame {
    /// Number of the trigger; in a table without numbers that of the row, from 1.
    pub sequence: u32,
    /// Name of the image, if one is known.
    pub image: Option<String>,
    /// Time of the trigger, camera time; `None` in a table of exposures.
    pub trigger: Option<Time>,
    /// Outcome of the trigger.
    pub outcome: Outcome,
    /// Names of the faults, with `; ` between them.
    pub faults: String,
    /// Names of the flags, with `; ` between them.
    pub flags: String,
    /// CRC-32 of the calibration that the camera had; `None` if it had no identity.
    pub calibration_crc: Option<u32>,
}

impl FlightFrame {
    /// Returns the exposure; `None` for a refused trigger.
    #[must_use]
    pub const fn exposed(&self) -> Option<&Exposed> {
        match &self.outcome {
            Outcome::Exposed(exposed) => Some(exposed),
            Outcome::Refused(_) => None,
        }
    }
}

/// Outcome of a trigger.
#[allow(clippy::large_enum_variant, reason = "most frames are exposed")]
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// An exposure with an interior orientation.
    Exposed(Exposed),
    /// No exposure that can be used; the reason in words.
    Refused(String),
}

/// An exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposed {
    /// Interior orientation, with the motion of the principal point that it comes from.
    pub interior: InteriorOrientation,
    /// Formula that turned the focus shift into the enlargement.
    pub focus_sign: FocusSign,
    /// First light, camera time.
    pub opened: Option<Time>,
    /// Last light, camera time.
    pub closed: Option<Time>,
    /// Centroid of the exposure, which goes with the principal point; camera time.
    pub centroid: Option<Time>,
    /// The centroid in UTC, where the record or the table has it.
    pub centroid_utc: Option<UtcTime>,
    /// σ of the principal point along the FMC axis, where the record or the table has it.
    pub sigma: Option<PrincipalPointSigma>,
}

impl Exposed {
    /// Returns the correction of this frame's points; `None` for the fitted model of a calibration
    /// without one.
    ///
    /// # Model
    /// That of [`Camera::frame_of`](fmc_camera::flight::camera::Camera::frame_of), with the
    /// principal point's motion and the focus shift of the record in place of those that the camera
    /// computed. A record holds both with all their digits, so the correction has the same bits.
    #[must_use]
    pub fn correction(&self, calibration: &Calibration) -> Option<FrameCorrection> {
        correction(
            calibration,
            &self.interior.motion,
            self.interior.model,
            self.interior.focus_shift_mm,
            self.focus_sign,
        )
    }

    /// Returns the correction of this frame's points with the residual grids of the camera; `None`
    /// as in [`Self::correction`].
    ///
    /// # Model
    /// That of [`GriddedFrame`](fmc_camera::flight::gridded_frame::GriddedFrame), with the bits
    /// that the camera itself computes.
    #[must_use]
    pub fn gridded<'a>(
        &self,
        calibration: &Calibration,
        grids: &CameraGrids<'a>,
    ) -> Option<GriddedCorrection<'a>> {
        let correction = self.correction(calibration)?;
        let interior = &self.interior;
        Some(gridded(
            correction,
            grids,
            interior.model,
            &interior.motion,
            interior.enlargement,
        ))
    }
}

/// Returns the correction of a frame with the residual grids of its camera: the model decides
/// whether the grid of the lens moves.
pub(crate) fn gridded<'a>(
    correction: FrameCorrection,
    grids: &CameraGrids<'a>,
    model: CorrectionModel,
    motion: &PrincipalPointMotion,
    enlargement: f32,
) -> GriddedCorrection<'a> {
    match model {
        CorrectionModel::Static => GriddedCorrection::calibrated(correction, grids),
        CorrectionModel::Exact => {
            GriddedCorrection::exposed(correction, grids, motion, enlargement)
        }
        CorrectionModel::Fitted => GriddedCorrection::exposed(correction, grids, motion, 0.0),
    }
}

/// Returns the correction of a motion and a focus shift, mm; `None` for the fitted model of a
/// calibration without one.
pub(crate) fn correction(
    calibration: &Calibration,
    motion: &PrincipalPointMotion,
    model: CorrectionModel,
    focus_shift_mm: f32,
    sign: FocusSign,
) -> Option<FrameCorrection> {
    match model {
        CorrectionModel::Exact => {
            let focus = focus_shift(calibration, focus_shift_mm, sign);
            Some(FrameCorrection::exact(calibration, motion, &focus))
        }
        CorrectionModel::Fitted => FrameCorrection::five_coefficient(calibration, motion),
        CorrectionModel::Static => Some(FrameCorrection::without_motion(calibration)),
    }
}

/// Returns a focus shift, mm, of a camera.
pub(crate) fn focus_shift(calibration: &Calibration, shift_mm: f32, sign: FocusSign) -> FocusShift {
    let parameters = calibration.parameters();
    FocusShift {
        shift_mm,
        principal_distance_mm: parameters.principal_distance_mm,
        exit_pupil_mm: parameters.exit_pupil_mm,
        sign,
    }
}
