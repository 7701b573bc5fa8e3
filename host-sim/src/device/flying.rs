//! The camera in this process, in a simulated flight.

use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::controller::{ControllerError, Start};
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{Rig, RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::io::instruments::Wire;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::digest;
use fmc_simulation::mission::wire::WireTraffic;

use super::{DeviceError, FlyingDevice, InProcess};

impl InProcess {
    /// Prepares the camera as [`FlyingDevice::prepare`] does, after a given kind of start.
    pub(super) fn prepare_after(
        &mut self,
        start: Start,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        Camera::new(*camera).map_err(DeviceError::Calibration)?;
        let kept = self.rig.as_ref().map_or(0, |rig| rig.controller().kept());
        if kept > 0 {
            return Err(DeviceError::RecordsKept(kept));
        }
        let start = match &self.rig {
            Some(rig) if start == Start::Orderly => rig.controller().next_start(),
            _ => start,
        };
        let crc = digest::of_camera(camera).unwrap_or_default();
        let rig = Rig::new(camera, crc, settings, start).map_err(|error| match error {
            ControllerError::Calibration(error) => DeviceError::Calibration(error),
            ControllerError::Settings(error) => DeviceError::Settings(error),
            ControllerError::Travel(error) => DeviceError::Frame(error),
        })?;
        self.rig = Some(rig);
        self.instruments.clear();
        Ok(())
    }

    /// The camera that has been prepared.
    fn rig(&mut self) -> Result<&mut Rig, DeviceError> {
        self.rig.as_mut().ok_or(DeviceError::NotPrepared)
    }
}

impl FlyingDevice for InProcess {
    type Error = DeviceError;

    fn description(&self) -> String {
        super::CorrectingDevice::description(self)
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        self.prepare_after(Start::Orderly, camera, settings)
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.rig.as_ref()?.controller().setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        Ok(self.rig()?.step(step))
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, DeviceError> {
        for byte in &traffic.receiver {
            self.instruments.push(Wire::Receiver, *byte);
        }
        for byte in &traffic.autopilot {
            self.instruments.push(Wire::Autopilot, *byte);
        }
        let step = self.instruments.wired(step);
        Ok(self.rig()?.step(&step))
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, DeviceError> {
        Ok(self.instruments.counters())
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        Ok(self.rig()?.controller().record(from_sequence))
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, DeviceError> {
        Ok(self.rig()?.controller_mut().acknowledge(through))
    }
}
