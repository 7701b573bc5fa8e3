//! The place of the one camera that a deck flies: loaded, and prepared for flight or not.

use core::fmt;

#[cfg(feature = "link")]
use super::calibration_id::CalibrationId;
use super::camera::Camera;
use super::controller::{
    Controller, ControllerError, NotExchanged, Preparation, Setup, Start, checked,
};
use super::drive::kind::DriveKind;
use super::drive::settings::DriveSettings;
#[cfg(feature = "link")]
use super::record_log::FIRST_BOOT;
use super::settings::FlightSettings;
use crate::geometry::range::OutOfRange;

/// The camera that is loaded, and the controller that flies it once it is prepared.
///
/// There is one copy of the camera. It stays where it is when it is prepared, and all users borrow
/// it from here, so that correction, adjustment and flight cannot use different calibrations.
#[derive(Debug, Clone)]
pub(crate) struct CameraSlot {
    /// Start of the next flight.
    start: Start,
    camera: Option<Camera>,
    /// Preparation of the camera; `None` before it is prepared.
    preparation: Option<Preparation>,
    /// Controller, made in its place at the first flight, so that a deck without one is moved
    /// without it.
    controller: Option<Controller>,
    /// Number of the last flight; 0 before the first.
    flight: u32,
    /// Number of the camera's start.
    #[cfg(feature = "link")]
    boot: u32,
    /// The controller has the records of a flight that a reset has ended, and that cannot go on.
    #[cfg(feature = "link")]
    holds_records: bool,
}

impl CameraSlot {
    /// Returns a slot without a camera.
    pub(crate) const fn new(start: Start) -> Self {
        Self {
            start,
            camera: None,
            preparation: None,
            controller: None,
            flight: 0,
            #[cfg(feature = "link")]
            boot: FIRST_BOOT,
            #[cfg(feature = "link")]
            holds_records: false,
        }
    }

    /// Puts a camera in place of the one before. It has to be prepared anew; the records of the
    /// flight before are gone.
    pub(crate) fn load(&mut self, camera: Camera) {
        self.start = self.next_start();
        self.preparation = None;
        #[cfg(feature = "link")]
        if core::mem::take(&mut self.holds_records)
            && let Some(controller) = &mut self.controller
        {
            controller.forget_records();
        }
        self.camera = Some(camera);
    }

    /// Checks that a camera may take the place of the one before in its flight; without a flight it
    /// may.
    pub(crate) fn check_exchange(&self, camera: &Camera) -> Result<(), NotExchanged> {
        let (Some(before), Some(preparation), Some(controller)) =
            (&self.camera, &self.preparation, &self.controller)
        else {
            return Ok(());
        };
        controller.check_exchange_for(&preparation.of(before), camera)
    }

    /// Puts a camera that is [checked](Self::check_exchange) in place of the one before, whose
    /// flight goes on; without a flight as [`Self::load`].
    pub(crate) fn exchange(&mut self, camera: Camera) {
        let (Some(preparation), Some(controller)) = (&mut self.preparation, &mut self.controller)
        else {
            self.load(camera);
            return;
        };
        preparation.exchange(&camera);
        controller.exchange(&camera);
        self.camera = Some(camera);
    }

    /// The camera; `None` before one is loaded.
    pub(crate) const fn camera(&self) -> Option<&Camera> {
        self.camera.as_ref()
    }

    /// Prepares the camera for flight; an earlier flight ends, and its records are gone. The drive
    /// takes its settings after all others have been accepted.
    ///
    /// # Errors
    /// [`NotFlyable`]; nothing has changed then.
    pub(crate) fn prepare(
        &mut self,
        settings: &FlightSettings,
        set_drive: impl FnOnce(DriveSettings) -> Result<(), OutOfRange>,
    ) -> Result<(), NotFlyable> {
        let (start, flight) = (self.next_start(), self.flight.saturating_add(1));
        self.prepare_after((start, flight), settings, set_drive)
    }

    /// As [`Self::prepare`], for the flight that a reset has ended.
    #[cfg(feature = "link")]
    pub(crate) fn prepare_after_reset(
        &mut self,
        settings: &FlightSettings,
        flies_on: bool,
        set_drive: impl FnOnce(DriveSettings) -> Result<(), OutOfRange>,
    ) -> Result<(), NotFlyable> {
        let start = if flies_on {
            Start::FliesOn
        } else {
            self.next_start()
        };
        self.prepare_after((start, self.flight), settings, set_drive)
    }

    /// As [`Self::prepare`], after a start of the camera, for the flight of a number.
    fn prepare_after(
        &mut self,
        (start, flight): (Start, u32),
        settings: &FlightSettings,
        set_drive: impl FnOnce(DriveSettings) -> Result<(), OutOfRange>,
    ) -> Result<(), NotFlyable> {
        let camera = self.camera.as_ref().ok_or(NotFlyable::NoCamera)?;
        let settings = checked(camera, settings).map_err(NotFlyable::Controller)?;
        set_drive(settings.drive)
            .map_err(|error| NotFlyable::Controller(ControllerError::Settings(error)))?;
        let preparation = self.preparation.insert(Preparation::new(camera, &settings));
        let controller = self.controller.get_or_insert_with(Controller::new);
        controller.restart(&preparation.of(camera), start);
        controller.set_flight(flight);
        self.flight = flight;
        #[cfg(feature = "link")]
        controller.set_boot(self.boot);
        self.start = match start {
            // The next flight does not go on from one before it.
            Start::FliesOn => Start::AfterWatchdog,
            other => other,
        };
        #[cfg(feature = "link")]
        {
            self.holds_records = false;
        }
        Ok(())
    }

    /// Sets the number of the camera's start and of its last flight.
    #[cfg(feature = "link")]
    pub(crate) const fn count_from(&mut self, boot: u32, flight: u32) {
        self.boot = boot;
        self.flight = flight;
    }

    /// Makes room for the records of a flight with this calibration, which a reset has ended and
    /// which cannot go on.
    #[cfg(feature = "link")]
    pub(crate) fn hold_records(&mut self, calibration: CalibrationId) {
        let controller = self.controller.get_or_insert_with(Controller::new);
        controller.hold(calibration);
        controller.set_flight(self.flight);
        controller.set_boot(self.boot);
        self.holds_records = true;
    }

    /// The controller that has records; `None` before the camera is prepared, unless it holds those
    /// of a flight before.
    #[cfg(feature = "link")]
    pub(crate) fn record_holder(&self) -> Option<&Controller> {
        let has_records = self.preparation.is_some() || self.holds_records;
        self.controller.as_ref().filter(|_| has_records)
    }

    /// The same, to acknowledge records.
    #[cfg(feature = "link")]
    pub(crate) fn record_holder_mut(&mut self) -> Option<&mut Controller> {
        let has_records = self.preparation.is_some() || self.holds_records;
        self.controller.as_mut().filter(|_| has_records)
    }

    /// Returns the start of a flight after the one in the slot; faults that have not been cleared
    /// are kept.
    ///
    /// A flight with an absolute sensor tells nothing of an encoder that counts: that has its place
    /// after such a flight as before.
    fn next_start(&self) -> Start {
        let Some(controller) = self.controller() else {
            return self.start;
        };
        let preparation = self.preparation.as_ref();
        let is_absolute = preparation.is_some_and(|flown| flown.settings().drive.is_absolute());
        match controller.next_start() {
            Start::Orderly if is_absolute && self.start != Start::Orderly => Start::Unreferenced,
            start => start,
        }
    }

    /// The controller; `None` before the camera is prepared.
    pub(crate) fn controller(&self) -> Option<&Controller> {
        self.controller
            .as_ref()
            .filter(|_| self.preparation.is_some())
    }

    /// The same, to acknowledge records.
    pub(crate) fn controller_mut(&mut self) -> Option<&mut Controller> {
        self.controller
            .as_mut()
            .filter(|_| self.preparation.is_some())
    }

    /// The camera with the controller that flies it, for events; `None` before it is prepared.
    pub(crate) fn flown(&mut self) -> Option<(Setup<'_>, &mut Controller)> {
        let setup = self.preparation.as_ref()?.of(self.camera.as_ref()?);
        Some((setup, self.controller.as_mut()?))
    }
}

/// The reason why a camera cannot be flown.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotFlyable {
    /// No camera is loaded.
    NoCamera,
    /// The controller refuses the settings, or the drive its own.
    Controller(ControllerError),
    /// The sensor is TDI, and the board has no output that clocks its rows.
    NoRowClock,
    /// The settings are for a kind of drive that the board does not have.
    OtherDrive(DriveKind),
}

impl fmt::Display for NotFlyable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCamera => f.write_str("no camera is loaded"),
            Self::Controller(error) => error.fmt(f),
            Self::NoRowClock => {
                f.write_str("the board has no output that clocks the rows of a TDI sensor")
            }
            Self::OtherDrive(asked) => {
                write!(
                    f,
                    "the settings are for {asked}, which the board does not have"
                )
            }
        }
    }
}

impl core::error::Error for NotFlyable {}
