//! Drive of a camera that is prepared again and again.

use super::FmcDrive;
use super::kind::DriveKind;
use super::settings::DriveSettings;
use crate::flight::fault::Fault;
use crate::flight::time::Time;
use crate::geometry::range::OutOfRange;

/// A mechanism that is built in: it takes the settings of each flight, and its zero at the stage's
/// present position.
pub trait FlownDrive: FmcDrive {
    /// Returns `true` if the drive is of this kind: a camera is not prepared with the
    /// settings of another. A motor keeps this default.
    fn is_of(&self, kind: DriveKind) -> bool {
        kind == DriveKind::Motor
    }

    /// Takes the settings of the flights to come.
    ///
    /// On return the drive is released, as new, and has kept its place: the count at the calibrated
    /// position is the same. A mechanism without such settings keeps this default.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field; the previous settings stay.
    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        let _ = settings;
        self.release();
        Ok(())
    }

    /// Drives the motor with a duty, -1 to 1, positive along the FMC axis, for trials of a board
    /// ([`Trial`](crate::flight::bring_up::Trial)); until the next call or a release. A mechanism
    /// without a motor of its own keeps this default.
    ///
    /// # Errors
    /// [`Fault::Drive`] where the duty cannot be set; the stage is released then.
    fn push(&mut self, now: Time, duty: f32) -> Result<(), Fault> {
        let _ = (now, duty);
        self.release();
        Err(Fault::Drive)
    }

    /// Returns the duty that is asked of the motor, -1 to 1, 0 if it is released: a trial ends if
    /// the encoder is silent under it. A mechanism that does not know it keeps this default, and
    /// counts as driven with [`MAX_DUTY`](crate::flight::bring_up::MAX_DUTY).
    fn asked_duty(&self) -> Option<f32> {
        None
    }

    /// Takes the present position of the stage as the calibrated one.
    fn set_reference(&mut self);
}
