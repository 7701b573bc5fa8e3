//! Wires between the camera and its stage, as its settings describe them.

use super::clock::ROUND_US;
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
    /// Pulses of a stepper's timer in a round; 0 without one.
    pulses: f64,
}

impl Wiring {
    /// Creates the wiring that the camera's settings describe.
    pub(super) fn of(scenario: &MissionScenario) -> Self {
        let drive = scenario.flight_settings().drive;
        let command = drive.is_absolute().then_some(drive.position_command);
        #[expect(clippy::cast_possible_truncation, reason = "some millions at most")]
        let zero = command.map_or(0, |command| command.sensor_zero_counts.round() as i32);
        let stepper = scenario.written.mechanics.stepper;
        Self {
            pulses: stepper.map_or(0.0, |stepper| (stepper.pulse_rate_hz * round_s()).round()),
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

    /// Returns the steps of a round, of which there are this part of the pulses: times after the
    /// round, s, evenly spread over it, and directions, 1 along the FMC axis and -1 against it.
    #[expect(clippy::cast_possible_truncation, reason = "at most a thousand")]
    pub(super) fn steps(&self, part: f64) -> impl Iterator<Item = (f64, i8)> + use<> {
        let made = (part * self.pulses).round() as i32;
        let direction = if made < 0 { -1 } else { 1 };
        let gap_s = round_s() / f64::from(made.abs().max(1));
        (0..made.abs()).map(move |step| ((f64::from(step) + 0.5) * gap_s, direction))
    }

    /// Returns the duty along the FMC axis for a duty at the camera's output, or the command from
    /// that at the calibrated position.
    pub(super) const fn duty(&self, duty: f64) -> f64 {
        let duty = duty - self.command_zero;
        if self.is_motor_reversed { -duty } else { duty }
    }
}

#[expect(clippy::cast_precision_loss, reason = "a millisecond")]
const fn round_s() -> f64 {
    ROUND_US as f64 * 1e-6
}
