//! Drive whose pins are numbers, for rigs and simulations.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};

use super::flown_drive::FlownDrive;
use super::kind::DriveKind;
use super::position_command::{CommandOutput, PositionCommand, PositionSensor, SensorReading};
use super::pwm_encoder::{Pins, PwmEncoder};
use super::quadrature::QuadratureCounter;
use super::settings::DriveSettings;
use super::step_dir::{StepDir, StepPins};
use super::{FmcDrive, StageReading};
use crate::flight::controller::timing::TICK_S;
use crate::flight::fault::Fault;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;
use crate::geometry::range::OutOfRange;

/// Steps of the pulse width, as a timer of 200 MHz has them at 20 kHz.
const FULL_DUTY: u16 = 10_000;

/// A pulse width that is a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Width(u16);

impl pwm::ErrorType for Width {
    type Error = Infallible;
}

impl SetDutyCycle for Width {
    fn max_duty_cycle(&self) -> u16 {
        FULL_DUTY
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0 = duty;
        Ok(())
    }
}

/// A pin that is a `bool`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Level(bool);

impl ErrorType for Level {
    type Error = Infallible;
}

impl OutputPin for Level {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0 = false;
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0 = true;
        Ok(())
    }
}

/// A counter that is set from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Count {
    count: i32,
    index: Option<i32>,
}

impl QuadratureCounter for Count {
    fn count(&mut self) -> i32 {
        self.count
    }

    fn take_index(&mut self) -> Option<i32> {
        self.index.take()
    }
}

/// A converter that is a number, and an amplifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Word(u16);

impl CommandOutput for Word {
    type Error = Infallible;

    fn max_word(&self) -> u16 {
        u16::MAX
    }

    fn set_word(&mut self, word: u16) -> Result<(), Infallible> {
        self.0 = word;
        Ok(())
    }

    fn release(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A sensor that is set from outside, read in the instant of the round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Place(i32);

impl PositionSensor for Place {
    type Error = Infallible;

    fn read(&mut self, now: Time) -> Result<SensorReading, Infallible> {
        Ok(SensorReading {
            time: now,
            counts: self.0,
        })
    }
}

/// Limit switch that is never closed: a rig tells of closed ones by events.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Open;

impl ErrorType for Open {
    type Error = Infallible;
}

impl InputPin for Open {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(true)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(false)
    }
}

/// A stepper whose timer's pulses of a round come all at once, after its set point.
#[derive(Debug, Clone)]
struct Steps {
    drive: StepDir<Level, Level, Open, Open>,
    pulses: u16,
    /// Steps of the last round.
    made: i16,
    is_powered: bool,
}

impl Steps {
    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        self.drive.follow(now, setpoint)?;
        let before = self.drive.steps();
        for _ in 0..self.pulses {
            self.drive.pulse();
        }
        let made = self.drive.steps().wrapping_sub(before);
        self.made = i16::try_from(made).unwrap_or(i16::MAX);
        self.is_powered = true;
        Ok(())
    }

    fn release(&mut self) {
        self.drive.release();
        self.made = 0;
        self.is_powered = false;
    }
}

/// The drive of a mechanism.
#[derive(Debug, Clone)]
enum Kind {
    Motor(PwmEncoder<Width, Level, Count>),
    Position(PositionCommand<Word, Place>),
    Steps(Steps),
}

/// [`PwmEncoder`], [`PositionCommand`] or [`StepDir`] without hardware, as the settings say: the
/// count comes in as a number, and duty, command or steps go out as one.
#[derive(Debug, Clone)]
pub struct RigDrive {
    kind: Kind,
}

impl RigDrive {
    /// Returns a drive without force; count 0 of a motor's encoder is the calibrated position.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn new(settings: DriveSettings) -> Result<Self, OutOfRange> {
        let kind = match settings.kind {
            DriveKind::Motor => {
                let pins = Pins {
                    pwm: Width::default(),
                    direction: Level::default(),
                    counter: Count::default(),
                };
                Kind::Motor(PwmEncoder::new(settings, pins)?)
            }
            DriveKind::PositionCommand => Kind::Position(PositionCommand::new(
                settings,
                Word::default(),
                Place::default(),
            )?),
            DriveKind::Stepper => {
                let pins = StepPins {
                    step: Level::default(),
                    direction: Level::default(),
                    low: Open,
                    high: Open,
                };
                let stepper = settings.checked()?.stepper;
                Kind::Steps(Steps {
                    drive: StepDir::new(stepper, pins)?,
                    pulses: pulses_of_round(stepper.pulse_rate_hz),
                    made: 0,
                    is_powered: false,
                })
            }
        };
        Ok(Self { kind })
    }

    /// Sets the present count of the encoder, or of the absolute sensor.
    pub const fn set_count(&mut self, count: i32) {
        match &mut self.kind {
            Kind::Motor(drive) => drive.pins_mut().counter.count = count,
            Kind::Position(drive) => drive.sensor_mut().0 = count,
            Kind::Steps(_) => {}
        }
    }

    /// Sets the count that was latched at the index mark since the last round, if it was crossed.
    pub const fn set_index(&mut self, index: Option<i32>) {
        if let Kind::Motor(drive) = &mut self.kind {
            drive.pins_mut().counter.index = index;
        }
    }

    /// Sets the present position of the stage, in counts of the encoder along the FMC axis from the
    /// calibrated position; that of an absolute sensor is a setting, and stays.
    pub fn set_position(&mut self, counts: i32) {
        match &mut self.kind {
            Kind::Motor(drive) => drive.set_position(counts),
            Kind::Position(_) => {}
            Kind::Steps(steps) => {
                steps.release();
                steps.drive.set_reference();
            }
        }
    }

    /// The duty at the bridge, -1 to 1, in the sense of its direction pin: low is positive; or the
    /// position command at the amplifier, -1 to 1; or the steps of this round along the FMC axis,
    /// in parts of the timer's pulses.
    #[must_use]
    pub fn duty(&self) -> f32 {
        match &self.kind {
            Kind::Motor(drive) => {
                let pins = drive.pins();
                let duty = f32::from(pins.pwm.0) / f32::from(FULL_DUTY);
                if pins.direction.0 { -duty } else { duty }
            }
            Kind::Position(drive) => 2.0 * f32::from(drive.output().0) / f32::from(u16::MAX) - 1.0,
            Kind::Steps(steps) => f32::from(steps.made) / f32::from(steps.pulses),
        }
    }

    /// Returns `true` if force is asked of the motor or the amplifier.
    #[must_use]
    pub const fn powered(&self) -> bool {
        match &self.kind {
            Kind::Motor(drive) => drive.is_powered(),
            Kind::Position(drive) => drive.is_powered(),
            Kind::Steps(steps) => steps.is_powered,
        }
    }
}

impl FmcDrive for RigDrive {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        match &mut self.kind {
            Kind::Motor(drive) => drive.position(now),
            Kind::Position(drive) => drive.position(now),
            Kind::Steps(steps) => steps.drive.position(now),
        }
    }

    fn take_index(&mut self) -> Option<f32> {
        match &mut self.kind {
            Kind::Motor(drive) => drive.take_index(),
            Kind::Position(drive) => drive.take_index(),
            Kind::Steps(steps) => steps.drive.take_index(),
        }
    }

    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        match &mut self.kind {
            Kind::Motor(drive) => drive.follow(now, setpoint),
            Kind::Position(drive) => drive.follow(now, setpoint),
            Kind::Steps(steps) => steps.follow(now, setpoint),
        }
    }

    fn release(&mut self) {
        match &mut self.kind {
            Kind::Motor(drive) => drive.release(),
            Kind::Position(drive) => drive.release(),
            Kind::Steps(steps) => steps.release(),
        }
    }
}

impl FlownDrive for RigDrive {
    fn is_of(&self, kind: DriveKind) -> bool {
        match &self.kind {
            Kind::Motor(drive) => drive.is_of(kind),
            Kind::Position(drive) => drive.is_of(kind),
            Kind::Steps(steps) => steps.drive.is_of(kind),
        }
    }

    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        match &mut self.kind {
            Kind::Motor(drive) => drive.set_settings(settings),
            Kind::Position(drive) => FlownDrive::set_settings(drive, settings),
            Kind::Steps(steps) => {
                steps.drive.set_settings(settings)?;
                steps.release();
                Ok(())
            }
        }
    }

    fn push(&mut self, now: Time, duty: f32) -> Result<(), Fault> {
        match &mut self.kind {
            Kind::Motor(drive) => drive.push(now, duty),
            Kind::Position(drive) => drive.push(now, duty),
            Kind::Steps(steps) => {
                steps.release();
                steps.drive.push(now, duty)
            }
        }
    }

    fn asked_duty(&self) -> Option<f32> {
        match &self.kind {
            Kind::Motor(drive) => drive.asked_duty(),
            Kind::Position(drive) => drive.asked_duty(),
            Kind::Steps(steps) => steps.drive.asked_duty(),
        }
    }

    fn set_reference(&mut self) {
        self.set_position(0);
    }
}

/// Returns the number of pulses of a stepper's timer in a round.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most 1000, by the range of the rate"
)]
fn pulses_of_round(rate_hz: f32) -> u16 {
    libm::roundf(rate_hz * TICK_S).max(1.0) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switch_of_a_rig_is_open_which_is_high() {
        assert_eq!((Open.is_high(), Open.is_low()), (Ok(true), Ok(false)));
    }
}
