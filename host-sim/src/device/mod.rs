//! The camera as host-sim sees it, wherever it runs.

mod sil;

use std::fmt;
use std::str::FromStr;

use fmc_camera::flight::camera::{CameraRecord, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::sensor::SensorPoint;

pub use sil::InProcess;

/// A camera that can be given a calibration, exposed, and asked to correct points.
pub trait Device {
    /// What it is, for the first line of a report.
    fn description(&self) -> String;

    /// Replaces the camera's calibration, mechanism, shutter and limits.
    ///
    /// # Errors
    /// [`DeviceError::Calibration`] where the camera refuses it; the previous one stays.
    fn load(&mut self, camera: &CameraRecord) -> Result<(), DeviceError>;

    /// Predicts a frame; the points that follow belong to it.
    ///
    /// # Errors
    /// [`DeviceError::Frame`] where the camera refuses the exposure.
    fn expose(&mut self, exposure: &Exposure) -> Result<FrameRecord, DeviceError>;

    /// Corrects measured points of the current frame, in order.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure.
    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError>;

    /// Distorts ideal points of the current frame, in order.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure; [`DeviceError::Distort`] for the first
    /// point that has no measured point.
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError>;
}

/// A device did not do what it was asked for.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DeviceError {
    /// It refuses the calibration.
    #[error("the camera refuses the calibration: {0}")]
    Calibration(CalibrationError),
    /// It refuses the exposure.
    #[error("the camera refuses the exposure: {0}")]
    Frame(FrameError),
    /// A point of a batch has no measured point.
    #[error("point {index} of the batch: {error}")]
    Distort {
        /// Index in the batch.
        index: usize,
        /// Why.
        error: DistortError,
    },
    /// It answered more or fewer points than it was asked.
    #[error("the camera was asked for {asked} points and answered {answered}")]
    Count {
        /// Points asked for.
        asked: usize,
        /// Points answered.
        answered: usize,
    },
    /// Points before the first exposure.
    #[error("the camera has not been exposed yet")]
    NoFrame,
}

impl DeviceError {
    /// Every point has its answer.
    ///
    /// # Errors
    /// [`DeviceError::Count`] where it has not.
    pub const fn check_count(asked: usize, answered: usize) -> Result<(), Self> {
        if asked == answered {
            Ok(())
        } else {
            Err(Self::Count { asked, answered })
        }
    }
}

/// A device as the command line names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceName {
    /// The camera's own code in this process.
    Sil,
}

impl DeviceName {
    /// Connects to the device.
    #[must_use]
    pub fn connect(self) -> Box<dyn Device> {
        match self {
            Self::Sil => Box::new(InProcess::default()),
        }
    }
}

impl FromStr for DeviceName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "sil" => Ok(Self::Sil),
            _ => Err("not a device; there is: sil".to_owned()),
        }
    }
}

impl fmt::Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sil => f.write_str("sil"),
        }
    }
}
