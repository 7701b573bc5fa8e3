//! The camera on a test rig: the wires of its drive, shutter and sensors are numbers, and its time
//! is given.

use super::camera::CameraParameters;
use super::control_loop::{ControlLoop, Events, RoundActions};
use super::controller::state::State;
use super::controller::{Controller, ControllerError, Start};
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
}

/// Outputs of the camera in a round.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigAnswer {
    /// Pulse width at the motor, -1 to 1; positive is along the FMC axis.
    pub duty: f32,
    /// `true` if the motor's power stage is on.
    pub powered: bool,
    /// Its other actions, in order.
    pub actions: RoundActions,
    /// State of the camera after the round.
    pub state: State,
}

/// A camera on a test rig.
#[derive(Debug)]
pub struct Rig {
    control: ControlLoop<RigDrive>,
}

impl Rig {
    /// Returns a camera in standby, its stage at the calibrated position where the encoder counts
    /// 0.
    ///
    /// # Errors
    /// As [`Controller::new`].
    #[inline]
    pub fn new(
        record: &CameraParameters,
        calibration_crc: u32,
        settings: &FlightSettings,
        start: Start,
    ) -> Result<Self, ControllerError> {
        let drive = RigDrive::new(settings.drive).map_err(ControllerError::Settings)?;
        // The controller is large: one copy of it is made, and no more.
        match Controller::new(record, calibration_crc, settings, start) {
            Ok(controller) => Ok(Self {
                control: ControlLoop::new(controller, drive),
            }),
            Err(error) => Err(error),
        }
    }

    /// Runs one round of the control loop.
    pub fn step(&mut self, step: &RigStep) -> RigAnswer {
        self.control.drive_mut().set_count(step.encoder_count);
        let actions = self.control.round(step.time, &step.events);
        RigAnswer {
            duty: self.control.drive().duty(),
            powered: self.control.drive().powered(),
            actions,
            state: self.control.controller().state(),
        }
    }

    /// The state machine.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        self.control.controller()
    }

    /// The state machine, for the acknowledgement of its records.
    pub const fn controller_mut(&mut self) -> &mut Controller {
        self.control.controller_mut()
    }
}
