//! Settings of a motor with an encoder.

use super::loop_settings::LoopSettings;
use crate::geometry::range::{OutOfRange, Quantity};

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
        }
    }
}

impl DriveSettings {
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

    /// Returns the play that the encoder does not see, mm.
    pub(crate) fn unseen_play_mm(&self) -> f32 {
        match self.encoder_side {
            EncoderSide::Screw => 1e-3 * self.play_um,
            EncoderSide::Stage => 0.0,
        }
    }

    /// Returns the settings, if each is in its range.
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
        Ok(self)
    }
}
