//! The camera in a simulated flight, wherever it runs.

use fmc_camera::flight::camera::CameraRecord;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

use crate::device::DeviceError;

/// A camera whose drive, shutter and sensors are simulated, one round of its control loop at a time.
pub trait FlyingDevice {
    /// What it is, for the first line of a report.
    fn description(&self) -> String;

    /// Gives it the camera's calibration and how it is flown, and starts its clock.
    ///
    /// # Errors
    /// [`DeviceError`] where it refuses them.
    fn prepare(
        &mut self,
        camera: &CameraRecord,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError>;

    /// Where the stage should be now; `None` where it has been told nothing, and where the device does not say.
    fn setpoint(&mut self, now: Time) -> Option<Setpoint> {
        let _ = now;
        None
    }

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
