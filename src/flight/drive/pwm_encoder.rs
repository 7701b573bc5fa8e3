//! Motor behind a bridge, driven by pulse width and direction, with a quadrature encoder.

use embedded_hal::digital::{OutputPin, PinState};
use embedded_hal::pwm::SetDutyCycle;

use super::flown_drive::FlownDrive;
use super::quadrature::QuadratureCounter;
use super::settings::DriveSettings;
use super::velocity_loop::VelocityLoop;
use super::{FmcDrive, Latches, StageReading};
use crate::flight::fault::Fault;
use crate::flight::shutter_edge::ShutterEdge;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;
use crate::geometry::range::OutOfRange;

/// Longest time without a set point, s; after a longer one the loop starts afresh.
const LONGEST_PAUSE_S: f32 = 0.005;

/// The pins and the counter of the drive.
#[derive(Debug, Clone)]
pub struct Pins<Pwm, Direction, Counter> {
    /// Pulse width of the bridge.
    pub pwm: Pwm,
    /// Direction of the bridge: low is positive duty.
    pub direction: Direction,
    /// The encoder.
    pub counter: Counter,
}

/// The drive: velocity loop, bridge and encoder.
///
/// With these pins [`release`](FmcDrive::release) can only set duty 0; the bridge determines if
/// that brakes or lets go. [`EnabledDrive`](super::enabled_drive::EnabledDrive) adds a pin that
/// lets go. The pulse width stays if calls fail to come: a device that works without them must then
/// take the bridge's enable away.
#[derive(Debug, Clone)]
pub struct PwmEncoder<Pwm, Direction, Counter> {
    pins: Pins<Pwm, Direction, Counter>,
    settings: DriveSettings,
    velocity_loop: VelocityLoop,
    /// The count at the calibrated position.
    zero: i32,
    /// Count of the newest reading, and the time for which it was asked.
    read: Option<(Time, i32)>,
    followed: Option<Time>,
    /// Duty of the newest request, positive along the FMC axis; 0 if released.
    asked_duty: f32,
    direction: Option<PinState>,
    release_failed: bool,
}

impl<Pwm, Direction, Counter> PwmEncoder<Pwm, Direction, Counter>
where
    Pwm: SetDutyCycle,
    Direction: OutputPin,
    Counter: QuadratureCounter,
{
    /// Returns a drive without force; count 0 is the calibrated position.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn new(
        settings: DriveSettings,
        pins: Pins<Pwm, Direction, Counter>,
    ) -> Result<Self, OutOfRange> {
        let mut drive = Self::unprepared(pins);
        drive.take_settings(settings)?;
        Ok(drive)
    }

    /// Returns a drive without force and with the default settings, until others are set.
    #[must_use]
    pub fn unprepared(pins: Pins<Pwm, Direction, Counter>) -> Self {
        let settings = DriveSettings::default();
        Self {
            pins,
            settings,
            velocity_loop: VelocityLoop::new(settings.velocity_loop),
            zero: 0,
            read: None,
            followed: None,
            asked_duty: 0.0,
            direction: None,
            release_failed: false,
        }
    }

    /// Sets the present position of the stage, in counts of the encoder along the FMC axis from the
    /// calibrated position: at its reference mark.
    pub fn set_position(&mut self, counts: i32) {
        let counts = if self.settings.encoder_reversed {
            counts.wrapping_neg()
        } else {
            counts
        };
        self.zero = self.pins.counter.count().wrapping_sub(counts);
        self.followed = None;
    }

    /// Takes other settings: the drive is released, the loop as new, the count at the calibrated
    /// position unchanged.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field; the previous settings stay.
    pub fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        self.take_settings(settings)?;
        self.release();
        // `motor_reversed` may have changed the meaning of the pin.
        self.direction = None;
        Ok(())
    }

    fn take_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        self.settings = settings.checked()?;
        self.velocity_loop = VelocityLoop::new(settings.velocity_loop);
        Ok(())
    }

    /// Returns `true` if force is asked of the motor.
    pub const fn is_powered(&self) -> bool {
        self.followed.is_some()
    }

    /// The pins, for inspection.
    pub(crate) const fn pins(&self) -> &Pins<Pwm, Direction, Counter> {
        &self.pins
    }

    /// The pins, to operate them.
    pub const fn pins_mut(&mut self) -> &mut Pins<Pwm, Direction, Counter> {
        &mut self.pins
    }

    /// Returns the place that a count shows which was taken at a time.
    fn reading(&self, taken: Time, count: i32) -> StageReading {
        StageReading {
            time: taken.plus_s(-self.settings.velocity_loop.reading_age_s),
            offset_mm: self.offset_mm(count),
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "exact to 16 million counts")]
    fn offset_mm(&self, count: i32) -> f32 {
        // The difference is right across a wrap of the counter.
        let counts = count.wrapping_sub(self.zero) as f32;
        let offset_mm = counts * (1e-3 * self.settings.encoder_step_um);
        if self.settings.encoder_reversed {
            -offset_mm
        } else {
            offset_mm
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the largest duty"
    )]
    fn drive(&mut self, duty: f32) -> Result<(), Fault> {
        self.asked_duty = duty;
        let duty = if self.settings.motor_reversed {
            -duty
        } else {
            duty
        };
        let direction = PinState::from(duty < 0.0);
        if self.direction != Some(direction) && duty.abs() > 0.0 {
            // No pulse of the old width must come in the new direction.
            self.direction = None;
            self.pins.pwm.set_duty_cycle(0).map_err(|_| Fault::Drive)?;
            self.pins
                .direction
                .set_state(direction)
                .map_err(|_| Fault::Drive)?;
            self.direction = Some(direction);
        }
        let full = self.pins.pwm.max_duty_cycle();
        let width = libm::roundf(duty.abs() * f32::from(full)) as u16;
        self.pins
            .pwm
            .set_duty_cycle(width.min(full))
            .map_err(|_| Fault::Drive)
    }
}

impl<Pwm, Direction, Counter> FmcDrive for PwmEncoder<Pwm, Direction, Counter>
where
    Pwm: SetDutyCycle,
    Direction: OutputPin,
    Counter: QuadratureCounter,
{
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        let count = self.pins.counter.count();
        self.read = Some((now, count));
        Ok(self.reading(now, count))
    }

    fn take_index(&mut self) -> Option<f32> {
        let count = self.pins.counter.take_index()?;
        Some(self.offset_mm(count))
    }

    fn take_latched(&mut self, edge: ShutterEdge, at: Time) -> Option<StageReading> {
        let count = self.pins.counter.take_latched(edge)?;
        Some(self.reading(at, count))
    }

    fn take_latches(&mut self) -> Latches {
        let mut latches = Latches::new();
        let Some((read, _)) = self.read else {
            return latches;
        };
        for (age_s, count) in self.pins.counter.take_latches() {
            // There are as many places.
            let _ = latches.push(self.reading(read.plus_s(-age_s), count));
        }
        latches
    }

    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        if core::mem::take(&mut self.release_failed) {
            self.release();
            return Err(Fault::Drive);
        }
        let dt_s = match self.followed {
            Some(before) => now.seconds_since(before),
            None => f32::INFINITY,
        };
        let dt_s = if (0.0..=LONGEST_PAUSE_S).contains(&dt_s) {
            dt_s
        } else {
            self.velocity_loop.restart();
            0.0
        };
        let count = match self.read {
            // The count of this instant: the stage's motion during the computation must not enter.
            Some((time, count)) if time == now => count,
            _ => self.pins.counter.count(),
        };
        let measured_mm = self.offset_mm(count);
        let duty = self.velocity_loop.duty(setpoint, measured_mm, dt_s);
        self.followed = Some(now);
        self.drive(duty).inspect_err(|_| self.release())
    }

    fn release(&mut self) {
        self.followed = None;
        self.asked_duty = 0.0;
        self.release_failed = self.pins.pwm.set_duty_cycle(0).is_err();
    }
}

impl<Pwm, Direction, Counter> FlownDrive for PwmEncoder<Pwm, Direction, Counter>
where
    Pwm: SetDutyCycle,
    Direction: OutputPin,
    Counter: QuadratureCounter,
{
    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        self.set_settings(settings)
    }

    fn push(&mut self, now: Time, duty: f32) -> Result<(), Fault> {
        if core::mem::take(&mut self.release_failed) {
            self.release();
            return Err(Fault::Drive);
        }
        // A set point that follows begins afresh.
        self.velocity_loop.restart();
        self.followed = Some(now);
        self.drive(duty).inspect_err(|_| self.release())
    }

    fn asked_duty(&self) -> Option<f32> {
        Some(self.asked_duty)
    }

    fn set_reference(&mut self) {
        self.set_position(0);
    }
}
