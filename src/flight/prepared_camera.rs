//! A camera that is prepared for a flight: calibration, settings and state machine.

use super::camera::Camera;
use super::controller::{Actions, Controller, ControllerError, Preparation, Setup, Start, checked};
use super::event::Event;
use super::settings::FlightSettings;
use super::time::Time;

/// A camera with the state machine that flies it, for callers that make the rounds of the control
/// loop themselves.
///
/// It holds the one copy of the camera, and hands it to the machine with every event, so that
/// no caller can hand it another.
#[derive(Debug, Clone)]
pub struct PreparedCamera {
    camera: Camera,
    preparation: Preparation,
    controller: Controller,
}

impl PreparedCamera {
    /// Returns a camera in standby. After a bite of the watchdog it begins with that fault.
    ///
    /// # Errors
    /// [`ControllerError`] naming what is not believable.
    pub fn new(
        camera: Camera,
        settings: &FlightSettings,
        start: Start,
    ) -> Result<Self, ControllerError> {
        let settings = checked(&camera, settings)?;
        let mut prepared = Self {
            preparation: Preparation::new(&camera, &settings),
            camera,
            controller: Controller::new(),
        };
        let (setup, controller) = prepared.flown();
        controller.restart(&setup, start);
        Ok(prepared)
    }

    /// Takes an event, and returns the actions that follow from it. Events come in order of their
    /// times; one that is older than the one before by more than
    /// [`LATE_EVENT_S`](super::controller::timing::LATE_EVENT_S), or later by more than
    /// [`CLOCK_JUMP_S`](super::controller::timing::CLOCK_JUMP_S), is a
    /// [`Fault::Clock`](super::fault::Fault::Clock).
    pub fn handle(&mut self, time: Time, event: Event) -> Actions {
        let (setup, controller) = self.flown();
        controller.handle(&setup, time, event)
    }

    /// The camera with the controller that flies it, for events.
    pub(super) const fn flown(&mut self) -> (Setup<'_>, &mut Controller) {
        (self.preparation.of(&self.camera), &mut self.controller)
    }

    /// The camera.
    #[must_use]
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &FlightSettings {
        self.preparation.settings()
    }

    /// The state machine.
    #[must_use]
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The state machine, to acknowledge its records.
    pub const fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }
}
