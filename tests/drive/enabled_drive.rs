//! The pin that enables the motor's power stage.

use std::io;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use fmc_camera::flight::drive::enabled_drive::EnabledDrive;
use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::{FmcDrive, StageReading};
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
