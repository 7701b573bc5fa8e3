//! The camera that is verified.

use std::error::Error;

use fmc_camera::flight::camera::CameraRecord;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::{Counters, Grid};

/// A camera that can be given a calibration, exposed, and asked to correct points.
pub trait CorrectingDevice: Send {
    /// How it fails.
    type Error: CorrectionFailure;

    /// What it is, for the first line of a report.
    fn description(&self) -> String;

    /// Replaces the camera's calibration, mechanism, shutter and limits.
    ///
    /// # Errors
    /// Where the camera refuses it; the previous one stays.
    fn load(&mut self, camera: &CameraRecord) -> Result<(), Self::Error>;

    /// Predicts a frame; the points that follow belong to it.
    ///
    /// # Errors
    /// Where the camera refuses the exposure.
    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, Self::Error>;

    /// Corrects measured points of the current frame, in order.
    ///
    /// # Errors
    /// Before the first exposure, and for the first point that is off the sensor.
    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, Self::Error>;

    /// Corrects a whole grid of measured points of the current frame. Over a link a digest shows
    /// that every point has the bits which the same code computes on this PC, and a sample of them
    /// is compared by value.
    ///
    /// # Errors
    /// As [`Self::correct`], and where a point has other bits.
    fn correct_grid(&mut self, grid: &Grid) -> Result<Vec<Corrected>, Self::Error> {
        self.correct(&grid.points().collect::<Vec<_>>())
    }

    /// How the points answered so far are known to be the camera's.
    fn evidence(&self) -> Evidence;

    /// What the camera's end of the link has seen since it started; nothing where there is no link.
    ///
    /// # Errors
    /// Where the camera cannot be talked to.
    fn counters(&mut self) -> Result<Option<Counters>, Self::Error> {
        Ok(None)
    }
}

/// How a camera that is verified fails.
pub trait CorrectionFailure: Error + Send {
    /// The camera answered more or fewer points than it was asked.
    fn of_count(asked: usize, answered: usize) -> Self;

    /// Whether the camera computes otherwise than its own code does on this PC.
    fn is_difference(&self) -> bool;
}

/// How points are known to be the camera's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Evidence {
    /// Points shown by a digest of the camera to have the bits computed here.
    pub by_digest: u64,
    /// Points that the camera itself answered.
    pub by_value: u64,
}
