//! A camera that is prepared for a flight: calibration, settings and state machine.

use core::mem::MaybeUninit;

use super::camera::Camera;
use super::controller::{
    Actions, Controller, ControllerError, NotExchanged, Preparation, Setup, Start, checked,
};
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
        let mut prepared = Self::unprepared(camera, &settings);
        prepared.begin(start);
        Ok(prepared)
    }

    /// Puts a camera in standby into a place, where it stays: a prepared camera takes 11 kB, and as
    /// much of the stack for every function that returns it.
    ///
    /// # Errors
    /// As [`Self::new`]; then nothing has been written.
    ///
    /// # Examples
    /// ```
    /// use core::mem::MaybeUninit;
    /// use fmc_camera::flight::camera::{Camera, CameraParameters};
    /// use fmc_camera::flight::controller::{Start, state::State};
    /// use fmc_camera::flight::prepared_camera::PreparedCamera;
    /// use fmc_camera::flight::settings::FlightSettings;
    /// use fmc_camera::CalibrationParameters;
    ///
    /// let calibration = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    /// let camera = Camera::new(CameraParameters::new(calibration))?;
    /// let mut place = MaybeUninit::uninit();
    /// let settings = FlightSettings::default();
    /// let prepared = PreparedCamera::new_in(&mut place, &camera, &settings, Start::Orderly)?;
    /// assert_eq!(prepared.controller().state(), State::Standby);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn new_in<'a>(
        place: &'a mut MaybeUninit<Self>,
        camera: &Camera,
        settings: &FlightSettings,
        start: Start,
    ) -> Result<&'a mut Self, ControllerError> {
        let settings = checked(camera, settings)?;
        let prepared = Self::put(place, camera, &settings);
        prepared.begin(start);
        Ok(prepared)
    }

    /// Puts a camera whose flight has not begun into a place. It is not inlined: its variables are
    /// off the stack before the flight begins, and not yet on it where settings are checked.
    #[inline(never)]
    fn put<'a>(
        place: &'a mut MaybeUninit<Self>,
        camera: &Camera,
        settings: &FlightSettings,
    ) -> &'a mut Self {
        place.write(Self::unprepared(camera.clone(), settings))
    }

    /// Returns a camera whose flight has not begun. It is inlined, so that it is made in its place.
    #[expect(
        clippy::inline_always,
        reason = "a call would return 11 kB on the stack"
    )]
    #[inline(always)]
    fn unprepared(camera: Camera, settings: &FlightSettings) -> Self {
        Self {
            preparation: Preparation::new(&camera, settings),
            camera,
            controller: Controller::new(),
        }
    }

    /// Begins the flight.
    fn begin(&mut self, start: Start) {
        let (setup, controller) = self.flown();
        controller.restart(&setup, start);
    }

    /// Puts another camera in place of this one, between two frames of the flight, which goes on:
    /// samples, UTC, counts and records stay, and each record names the calibration it was made
    /// with.
    ///
    /// # Errors
    /// [`NotExchanged`]; the camera before stays then.
    pub fn exchange(&mut self, camera: Camera) -> Result<(), NotExchanged> {
        let (setup, controller) = self.flown();
        controller.check_exchange_for(&setup, &camera)?;
        controller.exchange(&camera);
        self.preparation.exchange(&camera);
        self.camera = camera;
        Ok(())
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
