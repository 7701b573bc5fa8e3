//! Settings of a motor with an encoder.

use super::loop_settings::LoopSettings;
use crate::geometry::range::{OutOfRange, Quantity};

/// Settings of motor and encoder, as built in.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DriveSettings {
    /// Travel per count of the encoder, µm.
    pub encoder_step_um: f32,
    /// `true` if the encoder counts down along the FMC axis.
    pub encoder_reversed: bool,
    /// `true` if direction low and positive duty move the stage against the FMC axis.
    pub motor_reversed: bool,
    /// Gains and limits.
    pub velocity_loop: LoopSettings,
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            encoder_step_um: 0.1,
            encoder_reversed: false,
            motor_reversed: false,
            velocity_loop: LoopSettings::default(),
        }
    }
}

impl DriveSettings {
    /// Returns the settings, if each is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::EncoderStepUm.check(self.encoder_step_um)?;
        self.velocity_loop.checked()?;
        Ok(self)
    }
}
