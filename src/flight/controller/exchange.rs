//! The exchange of the camera's calibration between two frames.

use core::fmt;

use super::setup::{Setup, check_camera};
use super::{Controller, ControllerError};
use crate::flight::camera::Camera;

/// The reason why a calibration cannot take the place of another in a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotExchanged {
    /// A frame is in flight, or the camera is armed.
    FrameInFlight,
    /// So many records have not been acknowledged, of as many calibrations as are remembered
    /// ([`EARLIER_CALIBRATIONS`](crate::flight::flown_calibrations::EARLIER_CALIBRATIONS)).
    RecordsKept(u32),
    /// One camera has a stage, the other moves the charge in rows.
    OtherMechanism,
    /// The camera cannot be flown with the settings of the flight, or with its exposure time or
    /// focus shift.
    NotFlyable(ControllerError),
}

impl Controller {
    /// Checks that the calibration may be exchanged now: in standby, or in a fault, whose stage has
    /// no force.
    ///
    /// # Errors
    /// [`NotExchanged::FrameInFlight`] and [`NotExchanged::RecordsKept`].
    pub fn check_exchange(&self) -> Result<(), NotExchanged> {
        if self.is_busy() {
            return Err(NotExchanged::FrameInFlight);
        }
        let first_left = self.frame.kept.records().first_left();
        if self.calibrations.have_room(first_left) {
            Ok(())
        } else {
            Err(NotExchanged::RecordsKept(self.kept()))
        }
    }

    /// Notes that the board makes no rounds for a while in standby, of up to
    /// [`PAUSE_S`](super::timing::PAUSE_S), as when it writes its store: the next event is no jump
    /// of the clock.
    pub const fn note_pause(&mut self) {
        self.readiness.note_pause();
    }

    /// Checks that the flight goes on with a camera, now and after a reset, which takes its
    /// settings up anew.
    pub(in crate::flight) fn check_exchange_for(
        &self,
        setup: &Setup,
        camera: &Camera,
    ) -> Result<(), NotExchanged> {
        self.check_exchange()?;
        if camera.has_stage() != setup.camera.has_stage() {
            return Err(NotExchanged::OtherMechanism);
        }
        for exposure_s in [setup.settings.exposure_s, self.exposure_s] {
            check_camera(camera, setup.settings, exposure_s).map_err(NotExchanged::NotFlyable)?;
        }
        camera
            .check_focus_shift(self.focus_shift_with(camera))
            .map_err(|error| NotExchanged::NotFlyable(ControllerError::Travel(error)))
    }

    /// Goes on with another camera. Its limits of V/H hold from now on; samples, UTC, counts,
    /// records and the place of the stage stay. The last frame is no longer the latest: its points
    /// are not to be corrected with what the next calibration has beside it.
    pub(in crate::flight) fn exchange(&mut self, camera: &Camera) {
        self.aircraft.vh.set_limits(camera.limits().vh_per_s);
        let kept = &mut self.frame.kept;
        kept.forget_latest();
        let records = kept.records();
        let (last, first_left) = (records.last_sequence(), records.first_left());
        self.calibrations.exchange(camera.id(), last, first_left);
    }
}

impl fmt::Display for NotExchanged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FrameInFlight => f.write_str("the camera is armed or in flight"),
            Self::RecordsKept(count) => write!(
                f,
                "{count} frame records of several calibrations have not been acknowledged"
            ),
            Self::OtherMechanism => f.write_str(
                "the flight was prepared for another mechanism: a stage, or rows of a TDI sensor",
            ),
            Self::NotFlyable(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for NotExchanged {}
