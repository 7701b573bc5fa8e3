//! A camera on a rig in this process, without a link: the library's own code alone.

use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::flown_deck::NotFlyable;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{Rig, RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::instruments::{Instruments, Wire};
use fmc_camera_file::GridFiles;

use super::device::FlyingDevice;
use super::wire::WireTraffic;

/// A camera on a rig, which can be copied in flight.
#[derive(Debug, Clone)]
pub struct RigCamera {
    rig: Rig,
    instruments: Instruments,
}

/// A reason why a camera on a rig does not fly.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RigCameraError {
    /// The calibration is invalid.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The settings are refused.
    #[error(transparent)]
    NotFlyable(#[from] NotFlyable),
    /// The camera is not prepared.
    #[error("the camera is not prepared for flight")]
    NotPrepared,
}

impl Default for RigCamera {
    fn default() -> Self {
        Self {
            rig: Rig::new(Start::Orderly),
            instruments: Instruments::new(),
        }
    }
}

/// Returns the round with the events that the bytes on the wires lead to.
#[must_use]
pub fn wired(instruments: &mut Instruments, step: &RigStep, traffic: &WireTraffic) -> RigStep {
    for byte in &traffic.receiver {
        instruments.push(Wire::Receiver, *byte);
    }
    for byte in &traffic.autopilot {
        instruments.push(Wire::Autopilot, *byte);
    }
    instruments.wired(step)
}

impl FlyingDevice for RigCamera {
    type Error = RigCameraError;

    fn description(&self) -> String {
        "the camera's own code in this program".to_owned()
    }

    /// Grids do not matter to a flight.
    fn load_grids(&mut self, _grids: &GridFiles) -> Result<(), RigCameraError> {
        Ok(())
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), RigCameraError> {
        self.rig.load(Camera::new(*camera)?);
        self.rig.prepare(settings)?;
        self.instruments.clear();
        Ok(())
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.rig.controller()?.setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, RigCameraError> {
        self.rig.step(step).ok_or(RigCameraError::NotPrepared)
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, RigCameraError> {
        let step = wired(&mut self.instruments, step, traffic);
        self.step(&step)
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, RigCameraError> {
        Ok(self.instruments.counters())
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, RigCameraError> {
        let controller = self.rig.controller().ok_or(RigCameraError::NotPrepared)?;
        Ok(controller.record(from_sequence))
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, RigCameraError> {
        let controller = self.rig.controller_mut();
        let controller = controller.ok_or(RigCameraError::NotPrepared)?;
        Ok(controller.acknowledge(through))
    }
}
