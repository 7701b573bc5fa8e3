//! The camera in a simulated flight, wherever it runs.

use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{RigAnswer, RigStep};

use crate::device::DeviceError;

/// A camera whose drive, shutter and sensors are simulated, one round of its control loop at a time.
pub trait FlyingDevice {
    /// What it is, for the first line of a report.
    fn description(&self) -> String;

    /// One round of the control loop.
    ///
    /// # Errors
    /// [`DeviceError`] where it cannot be talked to.
    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError>;

    /// The oldest record with at least that number that has not been acknowledged.
    ///
    /// # Errors
    /// [`DeviceError`] where it cannot be talked to.
    fn record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError>;

    /// Records up to that number are safe; the camera may forget them.
    ///
    /// # Errors
    /// [`DeviceError`] where it cannot be talked to.
    fn acknowledge(&mut self, through: u32) -> Result<(), DeviceError>;
}
