//! What moves the stage.

use super::fault::Fault;
use super::stage::Setpoint;
use super::time::Time;

/// A position of the stage as its encoder has it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct StageReading {
    /// When it was read, camera time.
    pub time: Time,
    /// Offset along the FMC axis from the calibrated position, mm.
    pub offset_mm: f32,
}

/// A mechanism that moves the stage.
pub trait FmcDrive {
    /// Where the stage is now.
    ///
    /// # Errors
    /// [`Fault`] where that cannot be said.
    fn position(&mut self, now: Time) -> Result<StageReading, Fault>;

    /// Follows a set point, until the next call.
    ///
    /// # Errors
    /// [`Fault`] where it cannot.
    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault>;

    /// Takes the force off.
    fn release(&mut self);
}
