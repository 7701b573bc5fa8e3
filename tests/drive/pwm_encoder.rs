//! Drive by pulse width and direction, with the encoder's count.

use std::io;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::{digital, pwm};
use fmc_camera::flight::drive::FmcDrive;
use fmc_camera::flight::drive::loop_settings::LoopSettings;
use fmc_camera::flight::drive::pwm_encoder::{Pins, PwmEncoder};
use fmc_camera::flight::drive::quadrature::QuadratureCounter;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::range::Quantity;

#[derive(Debug, Clone, Copy)]
struct Count(i32);

impl QuadratureCounter for Count {
    fn count(&mut self) -> i32 {
        self.0
    }
}

const FULL: u16 = 1000;

fn tick(number: u64) -> Time {
    Time::from_us(1000 * number)
}

fn at(offset_mm: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        ..Setpoint::default()
    }
}

/// Returns settings that use the position alone: 1 mm/s per µm, 0.02 of duty per mm/s.
fn settings() -> DriveSettings {
    DriveSettings {
        velocity_loop: LoopSettings {
            position_gain_per_s: 1000.0,
            speed_gain_per_mm_s: 0.02,
            integral_rate_per_s: 0.0,
            slope_weight: 0.01,
            speed_feed_per_mm_s: 0.0,
            acceleration_feed_per_mm_s2: 0.0,
            friction_feed: 0.0,
            max_duty: 0.8,
            rest_band_um: 2.0,
            learning_rate_per_s: 0.0,
            reading_age_s: 0.0,
            duty_delay_s: 0.0,
        },
        ..DriveSettings::default()
    }
}

fn low() -> digital::Transaction {
    digital::Transaction::set(digital::State::Low)
}

fn high() -> digital::Transaction {
    digital::Transaction::set(digital::State::High)
}

fn full() -> pwm::Transaction {
    pwm::Transaction::max_duty_cycle(FULL)
}

fn width(of: u16) -> pwm::Transaction {
    pwm::Transaction::set_duty_cycle(of)
}

fn broken() -> MockError {
    MockError::Io(io::ErrorKind::Other)
}

/// Follows set points with these counts, one per millisecond, and then checks the traffic.
fn traffic(
    settings: DriveSettings,
    motion: &[(f32, i32)],
    pwm: &[pwm::Transaction],
    direction: &[digital::Transaction],
) -> Vec<Result<(), Fault>> {
    let pins = Pins {
        pwm: pwm::Mock::new(pwm),
        direction: digital::Mock::new(direction),
        counter: Count(0),
    };
    let (mut width, mut level) = (pins.pwm.clone(), pins.direction.clone());
    let mut drive = PwmEncoder::new(settings, pins).unwrap();
    let followed = (0..).zip(motion).map(|(number, (offset_mm, count))| {
        drive.pins_mut().counter = Count(*count);
        drive.follow(tick(number), at(*offset_mm))
    });
    let followed = followed.collect();
    drive.release();
    assert!(!drive.is_powered());
    width.done();
    level.done();
    followed
}

#[test]
fn loop_follows_from_the_count_that_was_read_in_its_round() {
    let mut drive = RigDrive::new(settings()).unwrap();
    let read = drive.position(tick(1)).unwrap();
    assert!(read.offset_mm.abs() < 1e-6);
    // The stage moves 10 µm further while the round computes.
    drive.set_count(100);
    drive.follow(tick(1), at(0.0)).unwrap();
    assert!(drive.duty().abs() < 1e-6, "{}", drive.duty());
    // A round that has not read the stage reads it now: 10 µm back, duty 0.2.
    drive.follow(tick(2), at(0.0)).unwrap();
    assert!((drive.duty() + 0.2).abs() < 0.01, "{}", drive.duty());
    // A round that has read the stage uses that reading.
    drive.position(tick(3)).unwrap();
    drive.set_count(0);
    drive.follow(tick(3), at(0.0)).unwrap();
    assert!((drive.duty() + 0.2).abs() < 0.01, "{}", drive.duty());
}

#[test]
fn short_motion_is_exactly_this_traffic() {
    let followed = traffic(
        settings(),
        // 20 µm to go, then at its place.
        &[(0.02, 0), (0.02, 200), (0.02, 200)],
        &[
            // 20 µm give 20 mm/s and a duty of 0.4.
            width(0),
            full(),
            width(400),
            // The slope has a weight of 1 %, which gives 0.2 mm/s: the stage rests.
            full(),
            width(0),
            full(),
            width(0),
            // The drive is released.
            width(0),
        ],
        &[low()],
    );
    assert_eq!(followed, [Ok(()), Ok(()), Ok(())]);
}

#[test]
fn direction_turns_while_there_is_no_pulse_and_duty_keeps_its_limit() {
    let reversed = DriveSettings {
        motor_reversed: true,
        ..settings()
    };
    let followed = traffic(
        reversed,
        // A set point 0.1 mm ahead, then one that jumps 0.1 mm back.
        &[(0.1, 0), (-0.1, 0), (-0.1, 0)],
        &[
            width(0),
            full(),
            width(800),
            width(0),
            full(),
            width(800),
            full(),
            width(800),
            width(0),
        ],
        &[high(), low()],
    );
    assert_eq!(followed, [Ok(()), Ok(()), Ok(())]);
}

#[test]
fn pin_that_fails_is_a_drive_fault_without_force_and_the_next_call_is_as_good_as_the_first() {
    let followed = traffic(
        settings(),
        &[(0.02, 0), (0.02, 0)],
        &[
            // The direction cannot be set, so that the pulse width stays zero.
            width(0),
            width(0),
            width(0),
            full(),
            width(400),
            width(0),
        ],
        &[low().with_error(broken()), low()],
    );
    assert_eq!(followed, [Err(Fault::Drive), Ok(())]);
}

#[test]
fn release_that_fails_is_reported_by_the_next_follow() {
    let followed = traffic(
        settings(),
        &[(0.02, 0), (0.02, 0), (0.02, 0)],
        &[
            width(0),
            full(),
            width(400).with_error(broken()),
            width(0).with_error(broken()),
            // The next call tries again.
            width(0),
            // Then as at first, except that the direction is known.
            full(),
            width(400),
            width(0),
        ],
        &[low()],
    );
    assert_eq!(followed, [Err(Fault::Drive), Err(Fault::Drive), Ok(())]);
}

#[test]
fn counter_that_wraps_goes_on_and_a_reversed_encoder_is_turned_round() {
    for reversed in [false, true] {
        let mut drive = RigDrive::new(DriveSettings {
            encoder_step_um: 0.5,
            encoder_reversed: reversed,
            ..settings()
        })
        .unwrap();
        let forth = if reversed { -1 } else { 1 };
        drive.set_count(i32::MAX - 100);
        drive.set_position(-2000);
        for (counts, offset_mm) in [(0, -1.0), (200, -0.9), (4000, 1.0)] {
            drive.set_count((i32::MAX - 100).wrapping_add(forth * counts));
            let reading = drive.position(tick(3)).unwrap();
            assert!((reading.offset_mm - offset_mm).abs() < 1e-6, "{reading:?}");
        }
    }
}

#[test]
fn reading_has_the_time_at_which_the_stage_was_there() {
    let mut aged = settings();
    aged.velocity_loop.reading_age_s = 2e-4;
    let mut drive = RigDrive::new(aged).unwrap();
    assert_eq!(drive.position(tick(5)).unwrap().time.us(), 4800);
}

#[test]
fn rig_shows_duty_and_power_and_starts_afresh_after_a_pause() {
    let mut drive = RigDrive::new(settings()).unwrap();
    assert!(!drive.powered() && drive.duty().abs() <= 0.0);
    drive.follow(tick(0), at(-0.01)).unwrap();
    assert!(drive.powered() && (drive.duty() + 0.2).abs() < 1e-6);
    drive.release();
    drive.release();
    assert!(!drive.powered() && drive.duty().abs() <= 0.0);
    // Counts that came during a pause do not count as speed: 20 µm, duty 0.4.
    drive.set_count(-300);
    drive.follow(tick(100), at(-0.01)).unwrap();
    assert!((drive.duty() - 0.4).abs() < 1e-6, "{}", drive.duty());
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let mut wrong = settings();
    wrong.velocity_loop.max_duty = f32::NAN;
    assert_eq!(
        RigDrive::new(wrong).unwrap_err().quantity,
        Quantity::MaxDuty
    );
    wrong = settings();
    wrong.encoder_step_um = 0.0;
    let refused = RigDrive::new(wrong).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "encoder_step_um = 0 is outside 0.001 to 100"
    );
}

#[test]
fn other_settings_release_the_motor_and_keep_the_zero() {
    let mut width = pwm::Mock::new(&[
        // 20 µm along the axis, duty 0.4.
        width(0),
        full(),
        width(400),
        // The new settings release the drive.
        width(0),
        // The pin is set again, because its meaning may have changed.
        width(0),
        full(),
        width(400),
        width(0),
    ]);
    let mut level = digital::Mock::new(&[low(), high()]);
    let pins = Pins {
        pwm: width.clone(),
        direction: level.clone(),
        counter: Count(5000),
    };
    let mut drive = PwmEncoder::new(settings(), pins).unwrap();
    drive.set_position(0);
    drive.follow(tick(0), at(0.02)).unwrap();

    let wrong = DriveSettings {
        encoder_step_um: 0.0,
        ..settings()
    };
    let error = drive.set_settings(wrong).unwrap_err();
    assert_eq!(error.quantity, Quantity::EncoderStepUm);
    assert!(drive.is_powered(), "nothing has changed");

    let reversed = DriveSettings {
        encoder_step_um: 0.2,
        motor_reversed: true,
        ..settings()
    };
    drive.set_settings(reversed).unwrap();
    assert!(!drive.is_powered());
    drive.pins_mut().counter = Count(5100);
    let reading = drive.position(tick(1)).unwrap();
    assert!((reading.offset_mm - 0.02).abs() < 1e-7, "{reading:?}");
    drive.follow(tick(1), at(0.04)).unwrap();
    drive.release();
    width.done();
    level.done();
}
