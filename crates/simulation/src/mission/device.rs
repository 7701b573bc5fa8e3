//! The camera that is flown.

use fmc_camera::flight::camera::CameraRecord;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

/// A camera whose drive, shutter and sensors are simulated, one round of its control loop at a time.
pub trait FlyingDevice {
    /// How it fails.
    type Error: std::error::Error;

    /// What it is, for the first line of a report.
    fn description(&self) -> String;

    /// Gives it the camera's calibration and how it is flown; it is in standby.
    ///
    /// # Errors
    /// Where it refuses them, or still has records that nobody has fetched.
    fn prepare(
        &mut self,
        camera: &CameraRecord,
        settings: &FlightSettings,
    ) -> Result<(), Self::Error>;

    /// Where the stage should be at a time; `None` where it has been told nothing.
    fn setpoint(&self, now: Time) -> Option<Setpoint>;

    /// One round of the control loop.
    ///
    /// # Errors
    /// Where it cannot be talked to.
    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, Self::Error>;

    /// The oldest record with at least that number that has not been acknowledged.
    ///
    /// # Errors
    /// Where it cannot be talked to.
    fn record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, Self::Error>;

    /// Records up to that number are safe; the camera may forget them. Says how many are left.
    ///
    /// # Errors
    /// Where it cannot be talked to.
    fn acknowledge(&mut self, through: u32) -> Result<u32, Self::Error>;
}
