//! Settings of a motor with an encoder.

use super::kind::DriveKind;
use super::loop_settings::LoopSettings;
use super::position_command_settings::PositionCommandSettings;
use super::step_settings::StepSettings;
use crate::geometry::range::{OutOfRange, Quantity};

/// Step whose rounding has the σ 1: √12.
const NOISE_STEPS: f32 = 3.464_101_6;

/// Part of the mechanism on which the encoder sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EncoderSide {
    /// The motor or its screw: the encoder does not see the play.
    #[default]
    Screw,
    /// The stage itself.
    Stage,
}

/// Settings of motor and encoder, as built in.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DriveSettings {
    /// Travel per count of the encoder, µm.
    pub encoder_step_um: f32,
    /// `true` if the encoder counts down along the FMC axis.
    pub encoder_reversed: bool,
    /// Part on which the encoder sits.
    pub encoder_side: EncoderSide,
    /// Play between screw and stage, µm. The encoder's zero is that of a stage which the screw
    /// pushes along the FMC axis.
    pub play_um: f32,
    /// σ of the encoder's scale, ppm of the offset from the calibrated position.
    pub encoder_scale_ppm: f32,
    /// σ of the encoder's zero, beyond that of its step, µm: the index mark, temperature.
    pub zero_sigma_um: f32,
    /// σ of [`LoopSettings::reading_age_s`], s.
    pub reading_age_sigma_s: f32,
    /// `true` if direction low and positive duty move the stage against the FMC axis.
    pub motor_reversed: bool,
    /// Gains and limits.
    pub velocity_loop: LoopSettings,
    /// Place of the index mark on the stage, mm along the FMC axis from the calibrated position;
    /// `None` without a mark.
    pub index_mm: Option<f32>,
    /// σ by which crossings of the mark differ from each other, µm.
    pub index_sigma_um: f32,
    /// Kind of the drive that these settings are for.
    pub kind: DriveKind,
    /// Command and sensor of [`DriveKind::PositionCommand`].
    pub position_command: PositionCommandSettings,
    /// Steps of [`DriveKind::Stepper`].
    pub stepper: StepSettings,
}

impl Default for DriveSettings {
    fn default() -> Self {
        Self {
            encoder_step_um: 0.1,
            encoder_reversed: false,
            encoder_side: EncoderSide::Screw,
            play_um: 5.0,
            encoder_scale_ppm: 20.0,
            zero_sigma_um: 0.05,
            reading_age_sigma_s: 2e-6,
            motor_reversed: false,
            velocity_loop: LoopSettings::default(),
            index_mm: None,
            index_sigma_um: 0.02,
            kind: DriveKind::Motor,
            position_command: PositionCommandSettings::default(),
            stepper: StepSettings::default(),
        }
    }
}

impl DriveSettings {
    /// Returns `true` if the sensor shows the place of the stage at any time, whatever has happened
    /// before: nothing is counted, so that no place can be lost, and no index mark is needed.
    #[must_use]
    pub const fn is_absolute(&self) -> bool {
        matches!(self.kind, DriveKind::PositionCommand)
    }

    /// Returns `true` if nothing measures the stage: its motion is that of the steps made.
    #[must_use]
    pub const fn is_stepped(&self) -> bool {
        matches!(self.kind, DriveKind::Stepper)
    }

    /// Returns the play in which an encoder on the stage stands still while the screw moves, mm.
    pub(crate) fn seen_play_mm(&self) -> f32 {
        match self.encoder_side {
            EncoderSide::Screw => 0.0,
            EncoderSide::Stage => 1e-3 * self.play_um,
        }
    }

    /// Returns a step of the encoder, mm.
    pub(crate) fn encoder_step_mm(&self) -> f32 {
        1e-3 * self.encoder_step_um
    }

    /// Returns the coarseness of a reading, µm: a step of the encoder, and with an absolute sensor
    /// one that is as uncertain as its noise.
    pub(crate) fn coarseness_um(&self) -> f32 {
        if self.is_absolute() {
            self.encoder_step_um + NOISE_STEPS * self.position_command.sensor_noise_um
        } else {
            self.encoder_step_um
        }
    }

    /// Returns the play that the encoder does not see, mm.
    pub(crate) fn unseen_play_mm(&self) -> f32 {
        match self.encoder_side {
            EncoderSide::Screw => 1e-3 * self.play_um,
            EncoderSide::Stage => 0.0,
        }
    }

    /// Returns the settings, if each is in its range. Those of a position command have no play,
    /// index mark and friction, and those of a stepper no index mark and no encoder, whatever was
    /// set.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::EncoderStepUm.check(self.encoder_step_um)?;
        Quantity::PlayUm.check(self.play_um)?;
        Quantity::EncoderScalePpm.check(self.encoder_scale_ppm)?;
        Quantity::ZeroSigmaUm.check(self.zero_sigma_um)?;
        Quantity::ReadingAgeSigmaS.check(self.reading_age_sigma_s)?;
        self.velocity_loop.checked()?;
        if let Some(index_mm) = self.index_mm {
            Quantity::IndexMm.check(index_mm)?;
        }
        Quantity::IndexSigmaUm.check(self.index_sigma_um)?;
        self.position_command.checked()?;
        self.stepper.checked()?;
        Ok(match self.kind {
            DriveKind::Motor => self,
            DriveKind::PositionCommand => self.without_motor(),
            DriveKind::Stepper => self.of_steps(),
        })
    }

    /// Returns the settings with a step as that of the encoder, which is counted as it is made: it
    /// has no age, and nothing can be latched at an index mark.
    fn of_steps(self) -> Self {
        Self {
            encoder_step_um: 1e3 / self.stepper.steps_per_mm,
            encoder_side: EncoderSide::Screw,
            encoder_reversed: false,
            reading_age_sigma_s: 0.0,
            index_mm: None,
            velocity_loop: LoopSettings {
                friction_feed: 0.0,
                reading_age_s: 0.0,
                ..self.velocity_loop
            },
            ..self
        }
    }

    /// Returns the settings with nothing that only a motor and its screw have: play, index mark and
    /// friction.
    fn without_motor(self) -> Self {
        Self {
            encoder_side: EncoderSide::Stage,
            play_um: 0.0,
            index_mm: None,
            velocity_loop: LoopSettings {
                friction_feed: 0.0,
                ..self.velocity_loop
            },
            ..self
        }
    }
}
