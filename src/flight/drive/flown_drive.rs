//! The drive of a camera that is prepared again and again.

use super::FmcDrive;
use super::settings::DriveSettings;
use crate::geometry::range::OutOfRange;

/// A mechanism that is built in: it takes the settings of each flight, and its zero where the stage stands.
pub trait FlownDrive: FmcDrive {
    /// Takes the settings of the flights to come.
    ///
    /// On return it is released, as new, and has kept its place: the count at the calibrated position is the same. A
    /// mechanism without such settings leaves this as it is.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field; the settings before stay.
    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        let _ = settings;
        self.release();
        Ok(())
    }

    /// The stage stands at the calibrated position.
    fn set_reference(&mut self);
}
