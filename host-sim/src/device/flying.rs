//! The camera in this process, in a simulated flight.

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::controller::{Controller, ControllerError, Start};
use fmc_camera::flight::flown_deck::NotFlyable;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{Rig, RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera_file::GridFiles;
use fmc_simulation::mission::rig_camera::wired;
use fmc_simulation::mission::wire::WireTraffic;

use super::{CorrectingDevice, DeviceError, FlyingDevice, InProcess};

impl InProcess {
    /// Prepares the camera as [`FlyingDevice::prepare`] does, after a given kind of start.
    pub(super) fn prepare_after(
        &mut self,
        start: Start,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        self.load(camera)?;
        if start != Start::Orderly {
            // The twin loses all that the camera has lost with its processor.
            self.rig = Rig::new(start);
            self.load(camera)?;
        }
        self.rig.prepare(settings).map_err(|error| match error {
            NotFlyable::Controller(error) => not_prepared(error),
            NotFlyable::NoCamera | NotFlyable::NoRowClock | NotFlyable::OtherDrive(_) => {
                DeviceError::NotPrepared
            }
        })?;
        self.instruments.clear();
        Ok(())
    }

    /// The controller of the camera that has been prepared.
    fn controller(&self) -> Result<&Controller, DeviceError> {
        self.rig.controller().ok_or(DeviceError::NotPrepared)
    }
}

/// Returns the error of a camera that refuses calibration or settings.
pub(super) const fn not_prepared(error: ControllerError) -> DeviceError {
    match error {
        ControllerError::Settings(error) => DeviceError::Settings(error),
        ControllerError::Travel(error) => DeviceError::Frame(error),
    }
}

impl FlyingDevice for InProcess {
    type Error = DeviceError;

    fn description(&self) -> String {
        super::CorrectingDevice::description(self)
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        CorrectingDevice::load_grids(self, grids)
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        self.prepare_after(Start::Orderly, camera, settings)
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.rig.controller()?.setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        self.rig.step(step).ok_or(DeviceError::NotPrepared)
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, DeviceError> {
        let step = wired(&mut self.instruments, step, traffic);
        self.rig.step(&step).ok_or(DeviceError::NotPrepared)
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, DeviceError> {
        Ok(self.instruments.counters())
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        Ok(self.controller()?.record(from_sequence))
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, DeviceError> {
        let controller = self.rig.controller_mut().ok_or(DeviceError::NotPrepared)?;
        Ok(controller.acknowledge(through))
    }
}
