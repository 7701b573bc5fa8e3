//! Wires between the camera and its stage, as its settings describe them.

use super::scenario::MissionScenario;

/// Signs and step of motor and encoder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wiring {
    is_encoder_reversed: bool,
    is_motor_reversed: bool,
    encoder_step_mm: f64,
    /// Count at the calibrated position.
    zero: i32,
    /// Command there.
    command_zero: f64,
}

impl Wiring {
    /// Creates the wiring that the camera's settings describe.
    pub(super) fn of(scenario: &MissionScenario) -> Self {
        let drive = scenario.flight_settings().drive;
        let command = drive.is_absolute().then_some(drive.position_command);
        #[expect(clippy::cast_possible_truncation, reason = "some millions at most")]
        let zero = command.map_or(0, |command| command.sensor_zero_counts.round() as i32);
        Self {
            zero,
            command_zero: command.map_or(0.0, |command| f64::from(command.command_zero)),
            is_encoder_reversed: drive.encoder_reversed,
            is_motor_reversed: drive.motor_reversed,
            encoder_step_mm: scenario.written.mechanics.encoder_step_um / 1000.0,
        }
    }

    /// Returns the count at the camera's input for a count along the FMC axis.
    pub(super) const fn count(&self, along_axis: i32) -> i32 {
        self.zero.wrapping_add(self.turned(along_axis))
    }

    /// Returns a difference of counts along the FMC axis for one at the input, and the other way.
    const fn turned(&self, counts: i32) -> i32 {
        if self.is_encoder_reversed {
            counts.wrapping_neg()
        } else {
            counts
        }
    }

    /// Returns the position that a count at the camera's input means, mm along the FMC axis.
    pub(super) fn encoder_mm(&self, count: i32) -> f64 {
        f64::from(self.turned(count.wrapping_sub(self.zero))) * self.encoder_step_mm
    }

    /// Returns the duty along the FMC axis for a duty at the camera's output, or the command from
    /// that at the calibrated position.
    pub(super) const fn duty(&self, duty: f64) -> f64 {
        let duty = duty - self.command_zero;
        if self.is_motor_reversed { -duty } else { duty }
    }
}
