//! Drive of a camera that is prepared again and again.

use super::FmcDrive;
use super::settings::DriveSettings;
use crate::geometry::range::OutOfRange;

/// A mechanism that is built in: it takes the settings of each flight, and its zero at the stage's
/// present position.
pub trait FlownDrive: FmcDrive {
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

    /// Takes the present position of the stage as the calibrated one.
    fn set_reference(&mut self);
}
