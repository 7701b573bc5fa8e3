//! Interface of the camera that is verified.

use std::error::Error;

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::{Counters, Grid};
use fmc_camera_file::GridFiles;

/// A camera that can be given a calibration, exposed, and asked to correct points.
pub trait CorrectingDevice: Send {
    /// Error of the device.
    type Error: CorrectionFailure;

    /// Describes the device, for the first line of a report.
    fn description(&self) -> String;

    /// Replaces the camera's calibration, mechanism, shutter and limits. The residual grids that
    /// the parameters state must have been [given](Self::load_grids) before.
    ///
    /// # Errors
    /// An error if the camera refuses them; the previous ones then stay.
    fn load(&mut self, camera: &CameraParameters) -> Result<(), Self::Error>;

    /// Gives the device the residual grids of the camera that is loaded next.
    ///
    /// # Errors
    /// An error if the device does not hold grids, and for a damaged one.
    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), Self::Error> {
        if grids.is_empty() {
            Ok(())
        } else {
            Err(Self::Error::of_grids())
        }
    }

    /// Predicts a frame, to which the points that follow belong.
    ///
    /// # Errors
    /// An error if the camera refuses the exposure.
    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, Self::Error>;

    /// Corrects measured points of the current frame, in order.
    ///
    /// # Errors
    /// An error before the first exposure, and for the first point that is off the sensor.
    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, Self::Error>;

    /// Corrects a whole grid of measured points of the current frame. Over a link, a digest shows
    /// that every point has the bits that the same code computes on this PC, and a sample of the
    /// points is compared by value.
    ///
    /// # Errors
    /// As [`Self::correct`], and if a point has other bits.
    fn correct_grid(&mut self, grid: &Grid) -> Result<Vec<Corrected>, Self::Error> {
        self.correct(&grid.points().collect::<Vec<_>>())
    }

    /// Returns the evidence that the points answered so far are the camera's.
    fn evidence(&self) -> Evidence;

    /// Returns the counters of the camera's end of the link since it started; `None` without a
    /// link.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    fn counters(&mut self) -> Result<Option<Counters>, Self::Error> {
        Ok(None)
    }
}

/// Error of a camera that is verified.
pub trait CorrectionFailure: Error + Send {
    /// Creates the error of a camera that answered more or fewer points than it was asked.
    fn of_count(asked: usize, answered: usize) -> Self;

    /// Creates the error of a camera that does not hold residual grids.
    fn of_grids() -> Self;

    /// Returns true if the camera computes otherwise than its own code on this PC.
    fn is_difference(&self) -> bool;
}

/// Evidence that points are the camera's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Evidence {
    /// Points shown by a digest of the camera to have the bits computed here.
    pub by_digest: u64,
    /// Points that the camera itself answered.
    pub by_value: u64,
}
