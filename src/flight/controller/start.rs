//! The start of a controller.

use super::Controller;
use super::aircraft::Aircraft;
use super::error::ControllerError;
use super::frame::FrameMachine;
use super::readiness::{Mode, Readiness};
use super::setup::{Setup, check_interval};
use super::stage::StageMachine;
use crate::flight::camera::{Camera, CameraParameters};
use crate::flight::fault::{Fault, Faults};
use crate::flight::settings::FlightSettings;
use crate::flight::smear_prediction::SmearPrediction;

/// Manner in which the camera came to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Start {
    /// The camera was switched on, or asked to start again.
    Orderly,
    /// The watchdog was not fed, or the processor failed.
    AfterWatchdog,
    /// As [`Self::Orderly`], but the encoder has lost its place.
    Unreferenced,
}

impl Controller {
    /// Returns the controller of a camera, in standby, or after a bite of the watchdog with that
    /// fault.
    ///
    /// # Errors
    /// [`ControllerError`] naming the quantity that is refused.
    pub fn new(
        record: &CameraParameters,
        calibration_crc: u32,
        settings: &FlightSettings,
        start: Start,
    ) -> Result<Self, ControllerError> {
        let camera = Camera::new(*record).map_err(ControllerError::Calibration)?;
        let settings = settings.checked().map_err(ControllerError::Settings)?;
        camera
            .check_exposure_time(settings.exposure_s)
            .map_err(|error| ControllerError::Travel(error.into()))?;
        check_interval(&camera, &settings)?;
        let mut faults = Faults::NONE;
        let mode = match start {
            Start::Orderly | Start::Unreferenced => Mode::Standby,
            Start::AfterWatchdog => {
                faults.insert(Fault::Watchdog);
                Mode::Fault(Fault::Watchdog)
            }
        };
        // The controller is made in its final place: it is large, and a copy would take as much of
        // the stack.
        Ok(Self {
            aircraft: Aircraft::new(&settings, camera.limits().vh_per_s),
            // The encoder's count is lost with the processor.
            stage: StageMachine::new(start != Start::Orderly && camera.has_stage()),
            frame: FrameMachine::new(faults),
            readiness: Readiness::new(mode),
            setup: Setup {
                smear: SmearPrediction::new(camera.calibration(), settings.direction),
                exposure_s: settings.exposure_s,
                camera,
                calibration_crc,
                settings,
            },
        })
    }

    /// Returns the start of the controller that replaces this one; faults that have not been
    /// cleared are kept.
    #[must_use]
    pub fn next_start(&self) -> Start {
        match self.readiness.mode() {
            Mode::Fault(Fault::Watchdog) => Start::AfterWatchdog,
            _ if self.stage.is_place_lost() => Start::Unreferenced,
            _ => Start::Orderly,
        }
    }
}
