//! Stepper with step and direction inputs, limit switches at both ends, and homing against the low
//! one.

use embedded_hal::digital::{InputPin, OutputPin, PinState};

use super::flown_drive::FlownDrive;
use super::kind::DriveKind;
use super::settings::DriveSettings;
use super::step_settings::StepSettings;
use super::{FmcDrive, StageReading};
use crate::flight::fault::Fault;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;
use crate::geometry::range::{OutOfRange, Quantity};

/// Time for which a set point is extrapolated, s; if none comes, the stage stands then.
const LONGEST_PAUSE_S: f32 = 0.005;

/// Distance of the target from the counted position at which a step is due, steps.
const STEP_ON: f32 = 0.5;

/// The same where the direction reverses, so that the stage does not chatter between two steps.
const STEP_BACK: f32 = 0.75;

/// The pins of the stepper.
#[derive(Debug, Clone)]
pub struct StepPins<Step, Direction, Low, High> {
    /// Steps on its rising edge.
    pub step: Step,
    /// Low is along the FMC axis.
    pub direction: Direction,
    /// Limit switch at the negative end.
    pub low: Low,
    /// Limit switch at the positive end.
    pub high: High,
}

/// Progress of homing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Homing {
    /// Homing was never asked for: offsets count from the position at switch-on.
    None,
    /// The stage is on the way to the low limit switch.
    Seeking,
    /// The stage is on the way back until the switch opens.
    BackingOff,
    /// The position is known.
    Done,
    /// Homing ended without a position: the switch did not close or open within the travel, a pin
    /// failed, or `release` interrupted it.
    Failed,
}

/// Desired position of the stage, extrapolated from pulse to pulse.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Target {
    steps: f32,
    steps_per_pulse: f32,
    steps_per_pulse2: f32,
    pulses_left: u32,
}

/// The drive: a set point every tick, interpolated into steps by [`pulse`](Self::pulse).
///
/// [`pulse`](Self::pulse) runs in a timer interrupt at a fixed rate; the methods of [`FmcDrive`]
/// run in the control loop, with that interrupt masked. The position is the number of steps made; a
/// stepper that loses steps does not report it, and has to be homed again.
#[derive(Debug, Clone)]
pub struct StepDir<Step, Direction, Low, High> {
    pins: StepPins<Step, Direction, Low, High>,
    settings: StepSettings,
    longest_pause_pulses: u32,
    least_gap_pulses: u32,
    target: Option<Target>,
    position: i32,
    homing: Homing,
    homing_steps_left: u32,
    upward: Option<bool>,
    step_is_high: bool,
    pulses_since_step: u32,
    pulses_since_turn: u32,
    fault: Option<Fault>,
}

impl<Step, Direction, Low, High> StepDir<Step, Direction, Low, High>
where
    Step: OutputPin,
    Direction: OutputPin,
    Low: InputPin,
    High: InputPin,
{
    /// Returns a stepper that stands, at offset 0.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn new(
        settings: StepSettings,
        pins: StepPins<Step, Direction, Low, High>,
    ) -> Result<Self, OutOfRange> {
        let settings = settings.checked()?;
        let [longest_pause_pulses, least_gap_pulses] = pauses(&settings);
        Ok(Self {
            pins,
            settings,
            longest_pause_pulses,
            least_gap_pulses,
            target: None,
            position: 0,
            homing: Homing::None,
            homing_steps_left: 0,
            upward: None,
            step_is_high: false,
            pulses_since_step: u32::MAX,
            pulses_since_turn: u32::MAX,
            fault: None,
        })
    }

    /// Starts homing: the stage goes to the low limit switch and back until it opens, which is at
    /// the homing offset.
    ///
    /// Homing goes on from pulse to pulse; meanwhile [`follow`](FmcDrive::follow) is refused.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, at most 20 million"
    )]
    pub fn start_homing(&mut self) {
        let StepSettings {
            steps_per_mm,
            homing_travel_mm,
            ..
        } = self.settings;
        self.homing = Homing::Seeking;
        self.homing_steps_left = libm::roundf(homing_travel_mm * steps_per_mm) as u32;
        self.target = None;
    }

    /// The pins, to operate them.
    pub const fn pins_mut(&mut self) -> &mut StepPins<Step, Direction, Low, High> {
        &mut self.pins
    }

    /// Steps made along the FMC axis, less those against it, from the calibrated position.
    pub const fn steps(&self) -> i32 {
        self.position
    }

    /// Progress of homing.
    pub const fn homing(&self) -> Homing {
        self.homing
    }

    /// Makes at most one edge of the step pin; the timer calls it.
    ///
    /// A step is a rising edge in one call and the falling one in the next. An error stops the
    /// stage and is reported by the next [`follow`](FmcDrive::follow).
    pub fn pulse(&mut self) {
        if let Err(fault) = self.try_pulse() {
            self.release();
            self.fault = Some(fault);
        }
    }

    fn try_pulse(&mut self) -> Result<(), Fault> {
        self.pulses_since_step = self.pulses_since_step.saturating_add(1);
        self.pulses_since_turn = self.pulses_since_turn.saturating_add(1);
        if self.step_is_high {
            self.pins.step.set_low().map_err(|_| Fault::Drive)?;
            self.step_is_high = false;
        }
        match self.homing {
            Homing::Seeking | Homing::BackingOff => self.home(),
            Homing::None | Homing::Done | Homing::Failed => self.track(),
        }
    }

    /// Makes one pulse of homing.
    #[expect(
        clippy::cast_precision_loss,
        reason = "a count of pulses between steps"
    )]
    fn home(&mut self) -> Result<(), Fault> {
        let closed = self.limit_closed(false)?;
        match (self.homing, closed) {
            (Homing::Seeking, true) => self.homing = Homing::BackingOff,
            (Homing::BackingOff, false) => {
                self.position =
                    nearest(self.settings.homing_offset_mm * self.settings.steps_per_mm);
                self.homing = Homing::Done;
                return Ok(());
            }
            _ => {}
        }
        let rate_hz = self.settings.homing_speed_mm_s * self.settings.steps_per_mm;
        if (self.pulses_since_step as f32) * rate_hz < self.settings.pulse_rate_hz {
            return Ok(());
        }
        if self.homing_steps_left == 0 {
            return Err(Fault::Drive);
        }
        let stepped = match (self.homing, self.step(self.homing == Homing::BackingOff)) {
            // The switch bounces.
            (Homing::Seeking, Err(Fault::LimitSwitch)) => false,
            (_, stepped) => stepped?,
        };
        self.homing_steps_left = self.homing_steps_left.saturating_sub(u32::from(stepped));
        Ok(())
    }

    /// Makes one pulse towards the target.
    #[expect(
        clippy::cast_precision_loss,
        reason = "exact to 16 million steps, more than a stroke has"
    )]
    fn track(&mut self) -> Result<(), Fault> {
        let Some(target) = &mut self.target else {
            return Ok(());
        };
        if target.pulses_left > 0 {
            target.pulses_left -= 1;
            target.steps += target.steps_per_pulse + 0.5 * target.steps_per_pulse2;
            target.steps_per_pulse += target.steps_per_pulse2;
        }
        let ahead = target.steps - self.position as f32;
        let upward = ahead > 0.0;
        let turns = self.upward.is_some_and(|before| before != upward);
        if ahead.abs() > if turns { STEP_BACK } else { STEP_ON } {
            self.step(upward)?;
        }
        Ok(())
    }

    /// Makes a step, or prepares it. Returns `true` if it was made.
    fn step(&mut self, upward: bool) -> Result<bool, Fault> {
        if self.limit_closed(upward)? {
            return Err(Fault::LimitSwitch);
        }
        if self.upward != Some(upward) {
            self.upward = None;
            let level = PinState::from(upward == self.settings.reversed);
            self.pins
                .direction
                .set_state(level)
                .map_err(|_| Fault::Drive)?;
            self.upward = Some(upward);
            self.pulses_since_turn = 0;
        }
        if self.pulses_since_turn < u32::from(self.settings.setup_pulses)
            || self.pulses_since_step < self.least_gap_pulses
        {
            return Ok(false);
        }
        self.pins.step.set_high().map_err(|_| Fault::Drive)?;
        self.step_is_high = true;
        self.pulses_since_step = 0;
        self.position = self.position.wrapping_add(if upward { 1 } else { -1 });
        Ok(true)
    }

    /// Returns `true` if the switch on that side is closed.
    fn limit_closed(&mut self, upward: bool) -> Result<bool, Fault> {
        let high = if upward {
            self.pins.high.is_high().map_err(|_| Fault::Drive)?
        } else {
            self.pins.low.is_high().map_err(|_| Fault::Drive)?
        };
        Ok(high != self.settings.limit_closed_low)
    }
}

impl<Step, Direction, Low, High> FmcDrive for StepDir<Step, Direction, Low, High>
where
    Step: OutputPin,
    Direction: OutputPin,
    Low: InputPin,
    High: InputPin,
{
    #[expect(
        clippy::cast_precision_loss,
        reason = "exact to 16 million steps, more than a stroke has"
    )]
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        Ok(StageReading {
            time: now,
            offset_mm: self.position as f32 / self.settings.steps_per_mm,
        })
    }

    fn follow(&mut self, _: Time, setpoint: Setpoint) -> Result<(), Fault> {
        if matches!(self.homing, Homing::Seeking | Homing::BackingOff) {
            return Err(Fault::Drive);
        }
        if let Some(fault) = self.fault.take() {
            self.target = None;
            return Err(fault);
        }
        let StepSettings {
            steps_per_mm,
            pulse_rate_hz,
            ..
        } = self.settings;
        let pulse_s = 1.0 / pulse_rate_hz;
        self.target = Some(Target {
            steps: setpoint.offset_mm * steps_per_mm,
            steps_per_pulse: setpoint.speed_mm_s * steps_per_mm * pulse_s,
            steps_per_pulse2: setpoint.acceleration_mm_s2 * steps_per_mm * pulse_s * pulse_s,
            pulses_left: self.longest_pause_pulses,
        });
        Ok(())
    }

    fn release(&mut self) {
        self.target = None;
        if matches!(self.homing, Homing::Seeking | Homing::BackingOff) {
            self.homing = Homing::Failed;
        }
    }
}

impl<Step, Direction, Low, High> FlownDrive for StepDir<Step, Direction, Low, High>
where
    Step: OutputPin,
    Direction: OutputPin,
    Low: InputPin,
    High: InputPin,
{
    fn is_of(&self, kind: DriveKind) -> bool {
        kind == DriveKind::Stepper
    }

    /// The pulse rate is that of the timer: another is refused. Settings of another kind of drive,
    /// as those of a trial, leave its own as they are.
    #[expect(
        clippy::cast_precision_loss,
        reason = "exact to 16 million steps, more than a stroke has"
    )]
    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        let settings = settings.checked()?;
        if self.is_of(settings.kind) {
            let stepper = settings.stepper;
            let rate_hz = self.settings.pulse_rate_hz;
            Quantity::PulseRateHz.check_within(stepper.pulse_rate_hz, rate_hz, rate_hz)?;
            let place_mm = self.position as f32 / self.settings.steps_per_mm;
            self.position = nearest(place_mm * stepper.steps_per_mm);
            [self.longest_pause_pulses, self.least_gap_pulses] = pauses(&stepper);
            self.settings = stepper;
            // `reversed` may have changed the meaning of the pin.
            self.upward = None;
            self.fault = None;
        }
        self.release();
        Ok(())
    }

    fn set_reference(&mut self) {
        self.release();
        self.position = 0;
    }
}

/// Returns the pulses after the last set point for which the stage goes on, and those from a step
/// to the next at least.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive, at most a million"
)]
fn pauses(settings: &StepSettings) -> [u32; 2] {
    [
        libm::roundf(LONGEST_PAUSE_S * settings.pulse_rate_hz) as u32,
        libm::ceilf(settings.pulse_rate_hz / settings.max_step_rate_hz) as u32,
    ]
}

#[expect(clippy::cast_possible_truncation, reason = "at most 10 million steps")]
fn nearest(steps: f32) -> i32 {
    libm::roundf(steps) as i32
}
