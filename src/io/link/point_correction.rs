//! Correction of the current frame's points, with the residual grids of the camera or without.

use super::digest;
use super::grid_loading::GridLoading;
use super::message::{Grid, Refusal};
use crate::flight::camera::Frame;
use crate::flight::gridded_frame::GriddedFrame;
use crate::geometry::frame_correction::{Corrected, FrameCorrection};
use crate::geometry::gridded_correction::GriddedCorrection;
use crate::geometry::inverse::DistortError;
use crate::geometry::sensor::SensorPoint;

/// Correction of the current frame. A camera without grids pays nothing for those of others.
#[derive(Debug, Clone, Copy)]
#[allow(clippy::large_enum_variant, reason = "no heap")]
pub(super) enum PointCorrection<'a> {
    /// That of a camera without grids.
    Polynomial(&'a FrameCorrection),
    /// That of a camera with grids.
    Gridded(GriddedCorrection<'a>),
}

impl<'a> PointCorrection<'a> {
    /// Returns the correction of the current frame.
    pub(super) fn of(frame: Option<&'a Frame>, grids: &'a GridLoading) -> Result<Self, Refusal> {
        let frame = frame.ok_or(Refusal::NoFrame)?;
        Ok(match grids.in_use() {
            None => Self::Polynomial(&frame.correction),
            Some(grids) => Self::Gridded(GriddedFrame::new(frame, &grids).correction),
        })
    }

    /// The polynomial, which knows the sensor.
    pub(super) const fn polynomial(&self) -> &FrameCorrection {
        match self {
            Self::Polynomial(correction) => correction,
            Self::Gridded(correction) => correction.polynomial(),
        }
    }

    pub(super) fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        match self {
            Self::Polynomial(correction) => correction.distort(ideal),
            Self::Gridded(correction) => correction.distort(ideal),
        }
    }

    pub(super) fn digest(&self, grid: &Grid) -> u32 {
        match self {
            Self::Polynomial(correction) => digest::of_grid(*correction, grid),
            Self::Gridded(correction) => digest::of_grid(correction, grid),
        }
    }
}
