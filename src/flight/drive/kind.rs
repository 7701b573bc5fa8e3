//! Kinds of drive, of which the settings of a flight name one.

use core::fmt;

/// Kind of the drive that moves the stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DriveKind {
    /// A motor under a velocity loop, with an incremental encoder
    /// ([`PwmEncoder`](super::pwm_encoder::PwmEncoder)).
    #[default]
    Motor,
    /// An amplifier that takes a position as an analogue command, with a sensor on the stage that
    /// shows its place at any time
    /// ([`PositionCommand`](super::position_command::PositionCommand)): a piezo with strain gauges
    /// or a capacitive sensor, a voice coil with an LVDT.
    PositionCommand,
    /// A stepper, whose steps are counted where they are made: nothing measures if the stage makes
    /// them ([`StepDir`](super::step_dir::StepDir)).
    Stepper,
}

impl DriveKind {
    /// The name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Motor => "a motor with an incremental encoder",
            Self::PositionCommand => "a position command with an absolute sensor",
            Self::Stepper => "a stepper",
        }
    }
}

impl fmt::Display for DriveKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
