//! The pin that enables the motor's power stage.

use std::io;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use fmc_camera::flight::drive::enabled_drive::EnabledDrive;
use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::{FmcDrive, Latches, StageReading};
use fmc_camera::flight::event::ShutterEdge;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

/// Motor that fails on request, and counts its releases.
#[derive(Debug, Default)]
struct Motor {
    fails: bool,
    released: u32,
}

impl FmcDrive for Motor {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        Ok(StageReading {
            time: now,
            offset_mm: 0.5,
        })
    }

    fn follow(&mut self, _: Time, setpoint: Setpoint) -> Result<(), Fault> {
        self.fails = setpoint.offset_mm < 0.0;
        if self.fails {
            Err(Fault::LimitSwitch)
        } else {
            Ok(())
        }
    }

    fn release(&mut self) {
        self.released += 1;
    }
}

impl FlownDrive for Motor {
    fn set_reference(&mut self) {}
}

fn low() -> Transaction {
    Transaction::set(State::Low)
}

fn high() -> Transaction {
    Transaction::set(State::High)
}

fn broken(level: Transaction) -> Transaction {
    level.with_error(MockError::Io(io::ErrorKind::NotConnected))
}

fn at(offset_mm: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        ..Setpoint::default()
    }
}

#[test]
fn pin_is_high_from_the_first_set_point_to_the_release() {
    let mut pin = Mock::new(&[low(), high(), high(), low(), high(), low()]);
    let mut drive = EnabledDrive::new(Motor::default(), pin.clone());
    let now = Time::START;
    assert_eq!(drive.position(now).map(|it| it.time), Ok(now));
    assert_eq!(drive.follow(now, at(0.0)), Ok(()));
    assert_eq!(drive.follow(now, at(0.1)), Ok(()));
    drive.release();
    assert_eq!(drive.follow(now, at(0.1)), Ok(()));
    drive.set_settings(DriveSettings::default()).unwrap();
    pin.done();
}

#[test]
fn drive_that_fails_takes_the_pin_away() {
    let mut pin = Mock::new(&[low(), high(), low(), high(), low()]);
    let mut drive = EnabledDrive::new(Motor::default(), pin.clone());
    assert_eq!(drive.follow(Time::START, at(0.0)), Ok(()));
    assert_eq!(drive.follow(Time::START, at(-0.1)), Err(Fault::LimitSwitch));
    // The next call works like the first.
    assert_eq!(drive.follow(Time::START, at(0.0)), Ok(()));
    drive.release();
    pin.done();
}

#[test]
fn pin_that_fails_is_reported_by_the_next_set_point() {
    let mut pin = Mock::new(&[low(), broken(high()), low(), broken(low()), low(), high()]);
    let mut drive = EnabledDrive::new(Motor::default(), pin.clone());
    assert_eq!(drive.follow(Time::START, at(0.0)), Err(Fault::Drive));
    drive.release();
    assert_eq!(drive.follow(Time::START, at(0.0)), Err(Fault::Drive));
    assert_eq!(drive.follow(Time::START, at(0.0)), Ok(()));
    pin.done();
}

/// Stepper with an index mark and capture inputs, and a duty.
#[derive(Debug, Default)]
struct Captured {
    duty: f32,
    is_referenced: bool,
}

impl FmcDrive for Captured {
    fn position(&mut self, _: Time) -> Result<StageReading, Fault> {
        Err(Fault::Encoder)
    }

    fn take_index(&mut self) -> Option<f32> {
        (!self.is_referenced).then_some(0.25)
    }

    fn take_latched(&mut self, edge: ShutterEdge, at: Time) -> Option<StageReading> {
        (edge == ShutterEdge::Closed).then_some(StageReading {
            time: at,
            offset_mm: 0.75,
        })
    }

    fn take_latches(&mut self) -> Latches {
        Latches::from_iter([StageReading {
            time: Time::START,
            offset_mm: 0.5,
        }])
    }

    fn follow(&mut self, _: Time, _: Setpoint) -> Result<(), Fault> {
        Ok(())
    }

    fn release(&mut self) {
        self.duty = 0.0;
    }
}

impl FlownDrive for Captured {
    fn is_of(&self, kind: DriveKind) -> bool {
        kind == DriveKind::Stepper
    }

    fn push(&mut self, _: Time, duty: f32) -> Result<(), Fault> {
        self.duty = duty;
        Ok(())
    }

    fn asked_duty(&self) -> Option<f32> {
        Some(self.duty)
    }

    fn set_reference(&mut self) {
        self.is_referenced = true;
    }
}

#[test]
fn drive_behind_the_pin_is_told_and_asked_everything() {
    let mut pin = Mock::new(&[low(), high(), low()]);
    let mut drive = EnabledDrive::new(Captured::default(), pin.clone());
    assert!(drive.is_of(DriveKind::Stepper) && !drive.is_of(DriveKind::Motor));
    assert_eq!(drive.position(Time::START), Err(Fault::Encoder));
    assert_eq!(drive.take_index(), Some(0.25));
    let at = Time::from_us(70);
    assert_eq!(drive.take_latched(ShutterEdge::Opened, at), None);
    let closed = drive.take_latched(ShutterEdge::Closed, at);
    assert_eq!(closed.map(|it| (it.time, it.offset_mm)), Some((at, 0.75)));
    let latches = drive.take_latches();
    let places = latches.iter().map(|it| it.offset_mm);
    assert_eq!(
        places.map(f32::to_bits).collect::<Vec<_>>(),
        [0.5_f32.to_bits()]
    );
    // A duty takes the pin high, and a release takes it low.
    assert_eq!(drive.push(Time::START, 0.125), Ok(()));
    assert_eq!(drive.asked_duty(), Some(0.125));
    drive.release();
    assert_eq!(drive.asked_duty(), Some(0.0));
    drive.set_reference();
    assert_eq!(drive.take_index(), None, "it has been referred");
    pin.done();
}

#[test]
fn motor_that_has_no_duty_takes_the_pin_away() {
    let mut pin = Mock::new(&[low(), high(), low()]);
    let mut drive = EnabledDrive::new(Motor::default(), pin.clone());
    assert!(drive.is_of(DriveKind::Motor) && drive.asked_duty().is_none());
    assert_eq!(drive.follow(Time::START, at(0.0)), Ok(()));
    assert_eq!(drive.push(Time::START, 0.1), Err(Fault::Drive));
    pin.done();
}
