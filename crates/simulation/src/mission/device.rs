//! Interface of the camera that is flown.

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::message::Counters;
use fmc_camera_file::GridFiles;

use super::wire::WireTraffic;

/// A camera whose drive, shutter and sensors are simulated, one round of its control loop at a
/// time.
pub trait FlyingDevice {
    /// Error of the connection to the camera.
    type Error: std::error::Error;

    /// Describes the camera, for the first line of a report.
    fn description(&self) -> String;

    /// Gives the camera the residual grids of the calibration that is loaded next.
    ///
    /// # Errors
    /// An error for a damaged grid.
    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), Self::Error>;

    /// Loads the camera's calibration and flight settings; the camera is then in standby.
    ///
    /// # Errors
    /// An error if it refuses them, or if it still has records that were not fetched.
    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), Self::Error>;

    /// Returns the set point of the stage at a time; `None` without one.
    fn setpoint(&self, now: Time) -> Option<Setpoint>;

    /// Performs one round of the control loop.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, Self::Error>;

    /// Performs one round of the control loop with the bytes that have come on the wires of
    /// receiver and autopilot since the round before.
    ///
    /// # Errors
    /// An error if the connection to the camera or one of its wires fails.
    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, Self::Error>;

    /// Returns the counts of the camera's end of its link; `None` for a camera without one.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    fn link_counters(&mut self) -> Result<Option<Counters>, Self::Error> {
        Ok(None)
    }

    /// Returns the counts of the wires of receiver and autopilot.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    fn instruments(&mut self) -> Result<InstrumentCounters, Self::Error>;

    /// Returns the oldest record that has at least this number and was not acknowledged.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, Self::Error>;

    /// Acknowledges the records up to this number, which the camera may then forget. Returns the
    /// number of records left.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    fn acknowledge(&mut self, through: u32) -> Result<u32, Self::Error>;
}

impl<D: FlyingDevice + ?Sized> FlyingDevice for &mut D {
    type Error = D::Error;

    fn description(&self) -> String {
        (**self).description()
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), Self::Error> {
        (**self).load_grids(grids)
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), Self::Error> {
        (**self).prepare(camera, settings)
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        (**self).setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, Self::Error> {
        (**self).step(step)
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, Self::Error> {
        (**self).step_with_wires(step, traffic)
    }

    fn link_counters(&mut self) -> Result<Option<Counters>, Self::Error> {
        (**self).link_counters()
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, Self::Error> {
        (**self).instruments()
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, Self::Error> {
        (**self).frame_record(from_sequence)
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, Self::Error> {
        (**self).acknowledge(through)
    }
}
