//! A frame whose points are being corrected.

use std::ops::Deref;

use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::exposure_distortion::ExposureDistortion;
use fmc_frames::{FrameRow, PlacedFrame};

use crate::device::PointBatch;

/// Points of a frame in a row from which the vectors are worth their start.
const BATCH: usize = 24;

/// A frame, and the vectors of this PC for its points.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActiveFrame<'a> {
    frame: PlacedFrame<'a>,
    /// Vectors for many points; `None` with residual grids.
    batch: Option<PointBatch>,
}

impl<'a> ActiveFrame<'a> {
    /// Creates the frame; `None` for a refused trigger. `principal_point_mm` is the calibrated one
    /// as the camera file has it.
    pub(super) fn new(
        row: &FrameRow,
        calibration: &Calibration,
        grids: &CameraGrids<'a>,
        principal_point_mm: [f64; 2],
    ) -> Option<Self> {
        let frame = PlacedFrame::new(row, calibration, grids, principal_point_mm)?;
        let correction = &frame.correction;
        Some(Self {
            batch: correction
                .is_polynomial()
                .then(|| PointBatch::new(correction.polynomial())),
            frame,
        })
    }

    /// Returns the vectors for a number of points, where they are worth it.
    pub(super) fn batch_of(&self, points: usize) -> Option<&PointBatch> {
        self.batch.as_ref().filter(|_| points >= BATCH)
    }
}

impl<'a> Deref for ActiveFrame<'a> {
    type Target = PlacedFrame<'a>;

    fn deref(&self) -> &PlacedFrame<'a> {
        &self.frame
    }
}
