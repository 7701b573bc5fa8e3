//! The frames of a flight with the camera that has taken them.

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::left_out_terms::LeftOut;
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_frames::{FrameTable, PlacedFrame};

use crate::frame_corrections::FrameCorrections;
use crate::frame_in_use::FrameInUse;

/// The camera of a flight, as far as points need it.
#[derive(Debug, Clone, Copy)]
pub struct FlightCamera<'a> {
    /// Its calibration.
    pub calibration: &'a Calibration,
    /// Its residual grids; a camera without has empty ones.
    pub grids: &'a CameraGrids<'a>,
    /// Its calibrated principal point as the camera file has it, sensor frame, mm.
    pub principal_point_mm: [f64; 2],
}

impl FlightCamera<'_> {
    /// Returns `true` for a camera without residual grids.
    pub(crate) const fn is_polynomial(&self) -> bool {
        self.grids.lens().is_none() && self.grids.sensor().is_none()
    }
}

/// The frames of a flight, and the camera that has taken them.
#[derive(Debug, Clone, Copy)]
pub struct Flight<'a> {
    /// The camera.
    pub camera: FlightCamera<'a>,
    /// The frames.
    pub table: &'a FrameTable,
    /// Their corrections, as far as they have been folded.
    pub corrections: &'a FrameCorrections,
}

impl<'a> Flight<'a> {
    /// Returns the correction of the frame at a place without residual grids; `None` for a refused
    /// trigger.
    pub(crate) fn correction(&self, place: usize) -> Option<&'a FrameCorrection> {
        let calibration = self.camera.calibration;
        self.corrections.correction(calibration, self.table, place)
    }

    /// Returns the frame at a place; `None` for a refused trigger.
    pub(crate) fn in_use(&self, place: usize) -> Option<FrameInUse<'a>> {
        let row = self.table.rows().get(place)?;
        let correction = self.correction(place)?;
        let FlightCamera {
            calibration,
            grids,
            principal_point_mm,
        } = self.camera;
        let placed =
            PlacedFrame::with_correction(row, *correction, calibration, grids, principal_point_mm)?;
        let left_out = left_out(calibration, correction, row.model()?, &row.motion);
        Some(FrameInUse::new(&placed, left_out))
    }
}

/// Returns the terms that the correction of a frame leaves out in single precision.
#[must_use]
pub fn left_out(
    calibration: &Calibration,
    correction: &FrameCorrection,
    model: CorrectionModel,
    motion: &PrincipalPointMotion,
) -> LeftOut {
    let second_moment_mm2 = match model {
        CorrectionModel::Exact => motion.moments.second,
        CorrectionModel::Fitted | CorrectionModel::Static => 0.0,
    };
    LeftOut::new(correction, second_moment_mm2, calibration.parameters().axis)
}
