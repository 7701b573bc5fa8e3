//! Wires between the camera and its stage, as its settings describe them.

use super::scenario::MissionScenario;

/// Signs and step of motor and encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wiring {
    is_encoder_reversed: bool,
    is_motor_reversed: bool,
    encoder_step_mm: f64,
}

impl Wiring {
    /// Creates the wiring that the camera's settings describe.
    pub(super) fn of(scenario: &MissionScenario) -> Self {
        let drive = scenario.flight_settings().drive;
        Self {
            is_encoder_reversed: drive.encoder_reversed,
            is_motor_reversed: drive.motor_reversed,
            encoder_step_mm: scenario.written.mechanics.encoder_step_um / 1000.0,
        }
    }

    /// Returns the count at the camera's input for a count along the FMC axis.
    pub(super) const fn count(&self, along_axis: i32) -> i32 {
        if self.is_encoder_reversed {
            along_axis.wrapping_neg()
        } else {
            along_axis
        }
    }

    /// Returns the position that a count at the camera's input means, mm along the FMC axis.
    pub(super) fn encoder_mm(&self, count: i32) -> f64 {
        f64::from(self.count(count)) * self.encoder_step_mm
    }

    /// Returns the duty along the FMC axis for a duty at the camera's output.
    pub(super) const fn duty(&self, duty: f64) -> f64 {
        if self.is_motor_reversed { -duty } else { duty }
    }
}
