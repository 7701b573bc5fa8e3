//! Drive whose pins are numbers, for rigs and simulations.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};

use super::flown_drive::FlownDrive;
use super::pwm_encoder::{Pins, PwmEncoder};
use super::quadrature::QuadratureCounter;
use super::settings::DriveSettings;
use super::{FmcDrive, StageReading};
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

/// [`PwmEncoder`] without hardware: the count comes in as a number, the duty goes out as one.
#[derive(Debug, Clone)]
pub struct RigDrive {
    drive: PwmEncoder<Width, Level, Count>,
}

impl RigDrive {
    /// Returns a drive without force; count 0 is the calibrated position.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn new(settings: DriveSettings) -> Result<Self, OutOfRange> {
        let pins = Pins {
            pwm: Width::default(),
            direction: Level::default(),
            counter: Count::default(),
        };
        Ok(Self {
            drive: PwmEncoder::new(settings, pins)?,
        })
    }

    /// Sets the encoder's present count.
    pub const fn set_count(&mut self, count: i32) {
        self.drive.pins_mut().counter.count = count;
    }

    /// Sets the count that was latched at the index mark since the last round, if it was crossed.
    pub const fn set_index(&mut self, index: Option<i32>) {
        self.drive.pins_mut().counter.index = index;
    }

    /// Sets the present position of the stage, in counts of the encoder along the FMC axis from the
    /// calibrated position.
    pub fn set_position(&mut self, counts: i32) {
        self.drive.set_position(counts);
    }

    /// The duty at the bridge, -1 to 1, in the sense of its direction pin: low is positive.
    #[must_use]
    pub fn duty(&self) -> f32 {
        let pins = self.drive.pins();
        let duty = f32::from(pins.pwm.0) / f32::from(FULL_DUTY);
        if pins.direction.0 { -duty } else { duty }
    }

    /// Returns `true` if force is asked of the motor.
    #[must_use]
    pub const fn powered(&self) -> bool {
        self.drive.is_powered()
    }
}

impl FmcDrive for RigDrive {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.drive.position(now)
    }

    fn take_index(&mut self) -> Option<f32> {
        self.drive.take_index()
    }

    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        self.drive.follow(now, setpoint)
    }

    fn release(&mut self) {
        self.drive.release();
    }
}

impl FlownDrive for RigDrive {
    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        self.drive.set_settings(settings)
    }

    fn push(&mut self, now: Time, duty: f32) -> Result<(), Fault> {
        self.drive.push(now, duty)
    }

    fn asked_duty(&self) -> Option<f32> {
        self.drive.asked_duty()
    }

    fn set_reference(&mut self) {
        self.drive.set_position(0);
    }
}
