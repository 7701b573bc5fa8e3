//! Counts that hardware latches for the drive of a motor: at edges of the shutter, between two
//! readings, and none.

use std::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::loop_settings::LoopSettings;
use fmc_camera::flight::drive::pwm_encoder::{Pins, PwmEncoder};
use fmc_camera::flight::drive::quadrature::{QuadratureCounter, WideCount};
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::{FmcDrive, MAX_LATCHES, StageReading};
use fmc_camera::flight::event::ShutterEdge;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::time::Time;
use heapless::Vec;

/// Pulse width that fails on request.
#[derive(Debug, Default)]
struct Width {
    duty: u16,
    fails: bool,
}

#[derive(Debug)]
struct Broken;

impl pwm::Error for Broken {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

impl pwm::ErrorType for Width {
    type Error = Broken;
}

impl SetDutyCycle for Width {
    fn max_duty_cycle(&self) -> u16 {
        1000
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        if self.fails {
            return Err(Broken);
        }
        self.duty = duty;
        Ok(())
    }
}

#[derive(Debug, Default)]
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

/// Counter of a timer with capture inputs.
#[derive(Debug, Default)]
struct Captured {
    count: i32,
    at_edge: Option<(ShutterEdge, i32)>,
    latches: Vec<(f32, i32), MAX_LATCHES>,
}

impl QuadratureCounter for Captured {
    fn count(&mut self) -> i32 {
        self.count
    }

    fn take_latched(&mut self, edge: ShutterEdge) -> Option<i32> {
        let (_, count) = self.at_edge.take_if(|(latched, _)| *latched == edge)?;
        Some(count)
    }

    fn take_latches(&mut self) -> Vec<(f32, i32), MAX_LATCHES> {
        self.latches.clone()
    }
}

/// Counter of a timer without capture inputs.
#[derive(Debug, Default)]
struct Plain(i32);

impl QuadratureCounter for Plain {
    fn count(&mut self) -> i32 {
        self.0
    }
}

type Drive<Counter> = PwmEncoder<Width, Level, Counter>;

/// Returns a drive whose readings are 0.1 ms old, with steps of 0.5 µm.
fn drive<Counter: QuadratureCounter + Default>() -> Drive<Counter> {
    let settings = DriveSettings {
        encoder_step_um: 0.5,
        velocity_loop: LoopSettings {
            reading_age_s: 1e-4,
            ..LoopSettings::default()
        },
        ..DriveSettings::default()
    };
    let pins = Pins {
        pwm: Width::default(),
        direction: Level::default(),
        counter: Counter::default(),
    };
    PwmEncoder::new(settings, pins).unwrap()
}

fn is_at(reading: StageReading, time_us: u64, offset_mm: f32) -> bool {
    reading.time == Time::from_us(time_us) && (reading.offset_mm - offset_mm).abs() < 1e-6
}

#[test]
fn count_at_an_edge_of_the_shutter_is_a_place_at_the_time_of_the_edge() {
    let mut drive = drive::<Captured>();
    drive.pins_mut().counter.at_edge = Some((ShutterEdge::Closed, 400));
    let at = Time::from_us(5500);
    assert_eq!(drive.take_latched(ShutterEdge::Opened, at), None);
    let latched = drive.take_latched(ShutterEdge::Closed, at).unwrap();
    assert!(is_at(latched, 5400, 0.2), "{latched:?}");
    assert_eq!(drive.take_latched(ShutterEdge::Closed, at), None);
}

#[test]
fn counts_between_two_readings_are_places_at_their_ages_before_the_last() {
    let mut drive = drive::<Captured>();
    drive.pins_mut().counter.latches = Vec::from_slice(&[(7.5e-4, 100), (2.5e-4, -300)]).unwrap();
    // Their ages are those at a reading, and there was none.
    assert!(drive.take_latches().is_empty());
    drive.position(Time::from_us(10_000)).unwrap();
    let latches = drive.take_latches();
    assert_eq!(latches.len(), 2);
    assert!(is_at(latches[0], 9150, 0.05), "{latches:?}");
    assert!(is_at(latches[1], 9650, -0.15), "{latches:?}");
}

#[test]
fn counter_without_capture_inputs_latches_nothing() {
    let mut drive = drive::<Plain>();
    drive.pins_mut().counter.0 = 200;
    let now = Time::from_us(2000);
    assert!(is_at(drive.position(now).unwrap(), 1900, 0.1));
    assert_eq!(drive.take_index(), None);
    assert_eq!(drive.take_latched(ShutterEdge::Opened, now), None);
    assert!(drive.take_latches().is_empty());
}

#[test]
fn place_of_the_stage_becomes_the_calibrated_one() {
    let mut drive = drive::<Plain>();
    drive.pins_mut().counter.0 = -77;
    FlownDrive::set_reference(&mut drive);
    let reading = drive.position(Time::from_us(2000)).unwrap();
    assert!(is_at(reading, 1900, 0.0), "{reading:?}");
}

#[test]
fn settings_of_a_flight_release_the_motor_and_wrong_ones_do_not() {
    let mut drive = drive::<Plain>();
    drive.push(Time::START, 0.2).unwrap();
    assert_eq!((drive.pins_mut().pwm.duty, drive.is_powered()), (200, true));
    let wrong = DriveSettings {
        encoder_step_um: f32::NAN,
        ..DriveSettings::default()
    };
    assert!(FlownDrive::set_settings(&mut drive, wrong).is_err());
    assert!(drive.is_powered());
    FlownDrive::set_settings(&mut drive, DriveSettings::default()).unwrap();
    assert_eq!((drive.pins_mut().pwm.duty, drive.is_powered()), (0, false));
}

#[test]
fn release_that_fails_is_reported_by_the_next_duty() {
    let mut drive = drive::<Plain>();
    drive.push(Time::START, -0.2).unwrap();
    assert!(drive.pins_mut().direction.0, "against the axis");
    drive.pins_mut().pwm.fails = true;
    drive.release();
    drive.pins_mut().pwm.fails = false;
    assert_eq!(drive.pins_mut().pwm.duty, 200, "the release has failed");
    assert_eq!(drive.push(Time::START, -0.2), Err(Fault::Drive));
    assert_eq!(drive.pins_mut().pwm.duty, 0, "it has been tried again");
    assert!(!drive.is_powered());
    assert_eq!(drive.push(Time::START, -0.2), Ok(()));
}

#[test]
fn timer_that_was_latched_before_or_after_the_last_count_is_near_it_across_a_wrap() {
    let mut wide = WideCount::new();
    wide.extend(32_000);
    wide.extend(64_000);
    assert_eq!(wide.extend(500), 66_036);
    assert_eq!(wide.near(400), 65_936);
    assert_eq!(wide.near(65_500), 65_500);
    assert_eq!(wide.near(600), 66_136);
    // The last count stays.
    assert_eq!(wide.extend(500), 66_036);
}
