//! The camera on a test rig: the wires of its drive, shutter and sensors are numbers, its time is given.

use super::camera::CameraParameters;
use super::control_loop::{ControlLoop, Events, RoundActions};
use super::controller::state::State;
use super::controller::{Controller, ControllerError, Start};
use super::drive::rig::RigDrive;
use super::settings::FlightSettings;
use super::time::Time;

/// What happens from one round of the control loop to the next.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigStep {
    /// When the control loop comes round.
    pub time: Time,
    /// What the encoder has counted by then.
    pub encoder_count: i32,
    /// What happened since the last round, in order of time.
    pub events: Events,
}

/// What the camera does in that round.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RigAnswer {
    /// Pulse width at the motor, -1 to 1; positive is along the FMC axis.
    pub duty: f32,
    /// Whether the motor's power stage is on.
    pub powered: bool,
    /// What else it does, in order.
    pub actions: RoundActions,
    /// What it is doing now.
    pub state: State,
}

/// A camera on a test rig.
#[derive(Debug)]
pub struct Rig {
    control: ControlLoop<RigDrive>,
}

impl Rig {
    /// A camera in standby, its stage at the calibrated position where the encoder counts 0.
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
        // One copy of the controller, which is large, and none more.
        match Controller::new(record, calibration_crc, settings, start) {
            Ok(controller) => Ok(Self {
                control: ControlLoop::new(controller, drive),
            }),
            Err(error) => Err(error),
        }
    }

    /// One round of the control loop.
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

    /// The state machine, to acknowledge its records.
    pub const fn controller_mut(&mut self) -> &mut Controller {
        self.control.controller_mut()
    }
}
