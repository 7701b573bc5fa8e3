//! The camera's own code in this process, on its test rig.

use fmc_camera::flight::camera::CameraRecord;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{Rig, RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::digest;

use super::flying_device::FlyingDevice;
use crate::device::DeviceError;

/// The camera in this process.
#[derive(Debug, Default)]
pub struct FlyingInProcess {
    rig: Option<Rig>,
}

impl FlyingInProcess {
    fn rig(&mut self) -> Result<&mut Rig, DeviceError> {
        self.rig
            .as_mut()
            .ok_or_else(|| DeviceError::Machine("the camera has no calibration yet".to_owned()))
    }
}

impl FlyingDevice for FlyingInProcess {
    fn description(&self) -> String {
        "sil (the camera's code in this process)".to_owned()
    }

    fn prepare(
        &mut self,
        camera: &CameraRecord,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        let crc = digest::of_record(camera).unwrap_or(0);
        let rig = Rig::new(camera, crc, *settings, Start::Orderly)
            .map_err(|error| DeviceError::Machine(format!("the camera refuses to fly: {error}")))?;
        self.rig = Some(rig);
        Ok(())
    }

    fn setpoint(&mut self, now: Time) -> Option<Setpoint> {
        self.rig.as_ref()?.controller().setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        Ok(self.rig()?.step(step))
    }

    fn record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        Ok(self.rig()?.controller().record(from_sequence))
    }

    fn acknowledge(&mut self, through: u32) -> Result<(), DeviceError> {
        self.rig()?.controller_mut().acknowledge(through);
        Ok(())
    }
}
