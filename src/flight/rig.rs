//! The camera on a test rig: the wires of its drive, shutter and sensors are numbers, and its time
//! is given.

#[cfg(feature = "link")]
use super::calibration_id::CalibrationId;
use super::camera::Camera;
use super::camera_slot::{CameraSlot, NotFlyable};
use super::control_loop::{self, Events, RoundActions};
use super::controller::state::State;
use super::controller::{Controller, NotExchanged, Start};
use super::drive::FmcDrive as _;
use super::drive::rig::RigDrive;
use super::settings::FlightSettings;
use super::time::Time;

/// Inputs of the camera from one round of the control loop to the next.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigStep {
    /// Time of the round.
    pub time: Time,
    /// Count of the encoder at that time.
    pub encoder_count: i32,
    /// Events since the last round, in order of time.
    pub events: Events,
    /// Count of the encoder at the index mark, if the stage has crossed it since the last round.
    pub index_count: Option<i32>,
}

/// Outputs of the camera in a round.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigAnswer {
    /// Pulse width at the motor, -1 to 1; positive is along the FMC axis. The position command, -1
    /// to 1, or the part of a stepper's pulses until the next round that are steps along the axis,
    /// with another kind of drive.
    pub duty: f32,
    /// `true` if the motor's power stage is on.
    pub powered: bool,
    /// Its other actions, in order.
    pub actions: RoundActions,
    /// State of the camera after the round.
    pub state: State,
}

impl RigAnswer {
    /// The outputs before a round: none.
    pub(crate) const fn silent() -> Self {
        Self {
            duty: 0.0,
            powered: false,
            actions: RoundActions::new(),
            state: State::Standby,
        }
    }
}

/// A camera on a test rig, with a new drive for every flight.
#[derive(Debug, Clone)]
pub struct Rig {
    camera: CameraSlot,
    drive: Option<RigDrive>,
}

impl Rig {
    /// A rig without a camera.
    #[must_use]
    pub const fn new(start: Start) -> Self {
        Self {
            camera: CameraSlot::new(start),
            drive: None,
        }
    }

    /// Puts a camera in place of the one before. It has to be prepared before it flies; an earlier
    /// flight has ended, and its records are gone.
    pub fn load(&mut self, camera: Camera) {
        self.camera.load(camera);
    }

    /// Checks that a camera may take the place of the one before in its flight
    /// ([`Self::exchange`]); without a flight it may.
    ///
    /// # Errors
    /// [`NotExchanged`].
    pub fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged> {
        self.camera.check_exchange(camera)
    }

    /// Puts a camera that has been [checked](Self::check_exchange) in place of the one before,
    /// between two frames of a flight, which goes on; without a flight as [`Self::load`].
    pub fn exchange(&mut self, camera: Camera) {
        self.camera.exchange(camera);
    }

    /// The camera; `None` before one is loaded.
    #[must_use]
    pub fn camera(&self) -> Option<&Camera> {
        self.camera.camera()
    }

    /// Prepares the loaded camera for flight, in standby, its stage at the calibrated
    /// position where the encoder counts 0. An earlier flight ends, and its records are gone.
    ///
    /// # Errors
    /// [`NotFlyable`]; an earlier flight goes on then.
    pub fn prepare(&mut self, settings: &FlightSettings) -> Result<(), NotFlyable> {
        let drive = &mut self.drive;
        let set_drive = |settings| {
            *drive = Some(RigDrive::new(settings)?);
            Ok(())
        };
        self.camera.prepare(settings, set_drive)
    }

    /// As [`Self::prepare`], for the flight that a reset has ended.
    #[cfg(feature = "link")]
    pub(crate) fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
    ) -> Result<(), NotFlyable> {
        let drive = &mut self.drive;
        let set_drive = |settings| {
            *drive = Some(RigDrive::new(settings)?);
            Ok(())
        };
        let camera = &mut self.camera;
        camera.prepare_after_reset(settings, flies_on, set_drive)
    }

    /// Sets the number of the camera's start and of its last flight.
    #[cfg(feature = "link")]
    pub(crate) const fn count_from(&mut self, boot: u32, flight: u32) {
        self.camera.count_from(boot, flight);
    }

    /// Makes room for the records of a flight that a reset has ended, in a camera that cannot be
    /// prepared for it again.
    #[cfg(feature = "link")]
    pub(crate) fn hold_records(&mut self, calibration: CalibrationId) {
        self.camera.hold_records(calibration);
    }

    /// The controller that has records, of a camera that is prepared or not.
    #[cfg(feature = "link")]
    pub(crate) fn record_holder(&self) -> Option<&Controller> {
        self.camera.record_holder()
    }

    /// The same, to acknowledge records.
    #[cfg(feature = "link")]
    pub(crate) fn record_holder_mut(&mut self) -> Option<&mut Controller> {
        self.camera.record_holder_mut()
    }

    /// Runs one round of the control loop; `None` before the camera is prepared.
    pub fn step(&mut self, step: &RigStep) -> Option<RigAnswer> {
        let mut answer = RigAnswer::silent();
        self.step_into(step, &mut answer)?;
        Some(answer)
    }

    /// Runs one round of the control loop and writes the outputs into an answer without actions,
    /// where they lie: a link's camera does not move them. `None` before the camera is prepared.
    pub(crate) fn step_into(&mut self, step: &RigStep, answer: &mut RigAnswer) -> Option<()> {
        let (setup, controller) = self.camera.flown()?;
        let drive = self.drive.as_mut()?;
        drive.set_count(step.encoder_count);
        drive.set_index(step.index_count);
        let reading = drive.position(step.time);
        control_loop::round(
            (&setup, controller),
            drive,
            step.time,
            reading,
            &step.events,
            &mut answer.actions,
        );
        answer.duty = drive.duty();
        answer.powered = drive.powered();
        answer.state = controller.state();
        Some(())
    }

    /// The state machine; `None` before the camera is prepared.
    #[must_use]
    pub fn controller(&self) -> Option<&Controller> {
        self.camera.controller()
    }

    /// The state machine, for the acknowledgement of its records.
    pub fn controller_mut(&mut self) -> Option<&mut Controller> {
        self.camera.controller_mut()
    }
}
