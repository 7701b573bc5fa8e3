//! Settings of a stepper.

use crate::geometry::range::{OutOfRange, Quantity};

/// Settings of a stepper with step and direction inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepSettings {
    /// Steps per millimetre of the stage, micro-steps counted as the driver counts them.
    pub steps_per_mm: f32,
    /// `true` if direction low moves the stage against the FMC axis.
    pub reversed: bool,
    /// Calls of [`pulse`](super::step_dir::StepDir::pulse) per second, Hz.
    pub pulse_rate_hz: f32,
    /// Most steps per second, at most half the pulse rate, Hz.
    pub max_step_rate_hz: f32,
    /// Pulses between a change of direction and the step after it: the driver's set-up time.
    pub setup_pulses: u8,
    /// `true` if a limit switch pulls its pin low when it closes.
    pub limit_closed_low: bool,
    /// Offset along the FMC axis at which the low limit switch opens, mm.
    pub homing_offset_mm: f32,
    /// Speed of homing, mm/s.
    pub homing_speed_mm_s: f32,
    /// Longest way to the low limit switch, mm.
    pub homing_travel_mm: f32,
    /// σ by which the stage is off the steps that are made, µm: friction by the stiffness of the
    /// rotor in its field, uneven micro-steps.
    pub following_sigma_um: f32,
}

impl Default for StepSettings {
    /// 1 mm of pitch, 200 steps, 16 micro-steps; 40 kHz.
    fn default() -> Self {
        Self {
            steps_per_mm: 3200.0,
            reversed: false,
            pulse_rate_hz: 40_000.0,
            max_step_rate_hz: 20_000.0,
            setup_pulses: 1,
            limit_closed_low: true,
            homing_offset_mm: -2.2,
            homing_speed_mm_s: 1.0,
            homing_travel_mm: 10.0,
            following_sigma_um: 5.0,
        }
    }
}

impl StepSettings {
    /// Returns the settings, if each is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::StepsPerMm.check(self.steps_per_mm)?;
        let pulse_rate = Quantity::PulseRateHz.check(self.pulse_rate_hz)?;
        let most = 0.5 * pulse_rate;
        let rate = Quantity::MaxStepRateHz.check_within(self.max_step_rate_hz, 1.0, most)?;
        Quantity::HomingOffsetMm.check(self.homing_offset_mm)?;
        let fastest = rate / self.steps_per_mm;
        Quantity::HomingSpeedMmS.check_within(self.homing_speed_mm_s, 1e-3, fastest)?;
        Quantity::HomingTravelMm.check(self.homing_travel_mm)?;
        Quantity::FollowingSigmaUm.check(self.following_sigma_um)?;
        Ok(self)
    }
}
