//! The analogue position command: sensor, command, correction, and their failures.

use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::position_command::{
    CommandOutput, PositionCommand, PositionSensor, SensorReading,
};
use fmc_camera::flight::drive::position_command_settings::PositionCommandSettings;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::{FmcDrive, StageReading};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

/// Largest word of the output: 12 bits.
const FULL: u16 = 4095;

/// Output that fails on request.
#[derive(Debug, Clone, Default)]
struct Output {
    word: Option<u16>,
    fails: bool,
    release_fails: bool,
}

impl CommandOutput for Output {
    type Error = ();

    fn max_word(&self) -> u16 {
        FULL
    }

    fn set_word(&mut self, word: u16) -> Result<(), ()> {
        self.word = Some(word);
        if self.fails { Err(()) } else { Ok(()) }
    }

    fn release(&mut self) -> Result<(), ()> {
        self.word = None;
        if self.release_fails { Err(()) } else { Ok(()) }
    }
}

/// Sensor with a reading, or none.
#[derive(Debug, Clone, Copy, Default)]
struct Sensor(Option<SensorReading>);

impl PositionSensor for Sensor {
    type Error = ();

    fn read(&mut self, _: Time) -> Result<SensorReading, ()> {
        self.0.ok_or(())
    }
}

type Drive = PositionCommand<Output, Sensor>;

/// Stage of ±100 µm whose sensor has 10 nm per count, and count 1000 at the calibrated position.
fn settings() -> DriveSettings {
    let mut settings = DriveSettings {
        kind: DriveKind::PositionCommand,
        encoder_step_um: 0.01,
        position_command: PositionCommandSettings {
            command_travel_um: 200.0,
            command_zero: 0.25,
            lag_s: 2e-3,
            acceleration_lag_s2: 1e-6,
            correction_rate_per_s: 100.0,
            max_correction_um: 5.0,
            sensor_zero_counts: 1000.0,
            sensor_least_counts: -15_000.0,
            sensor_most_counts: 15_000.0,
            sensor_frozen_s: 0.02,
            ..PositionCommandSettings::default()
        },
        ..DriveSettings::default()
    };
    settings.velocity_loop.reading_age_s = 3e-4;
    settings.velocity_loop.duty_delay_s = 1e-4;
    settings
}

fn drive(settings: DriveSettings) -> Drive {
    PositionCommand::new(settings, Output::default(), Sensor::default()).unwrap()
}

fn ms(ms: u32) -> Time {
    Time::from_us(u64::from(ms) * 1000)
}

/// Returns what the drive makes of a reading.
fn read(drive: &mut Drive, now: Time, at: Time, counts: i32) -> Result<StageReading, Fault> {
    drive.sensor_mut().0 = Some(SensorReading { time: at, counts });
    drive.position(now)
}

fn resting(offset_mm: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        ..Setpoint::default()
    }
}

/// Returns the word of a command, -1 to 1.
fn word(command: f32) -> f32 {
    0.5 * (command + 1.0) * f32::from(FULL)
}

fn commanded(drive: &mut Drive) -> f32 {
    f32::from(drive.output_mut().word.unwrap())
}

#[test]
fn reading_is_in_steps_from_its_zero_at_the_time_of_its_conversion_less_its_age() {
    let mut along = drive(settings());
    let reading = read(&mut along, ms(10), Time::from_us(9500), 3000).unwrap();
    assert_eq!(reading.time, Time::from_us(9200));
    assert!((reading.offset_mm - 0.02).abs() < 1e-8, "{reading:?}");
    let mut against = drive(DriveSettings {
        encoder_reversed: true,
        ..settings()
    });
    let reading = read(&mut against, ms(10), ms(10), 3000).unwrap();
    assert!((reading.offset_mm + 0.02).abs() < 1e-8, "{reading:?}");
}

#[test]
fn sensor_that_is_silent_old_saturated_or_frozen_is_a_fault_until_it_reads_again() {
    let mut one = drive(settings());
    assert_eq!(one.position(ms(1)), Err(Fault::Encoder));
    assert!(read(&mut one, ms(12), ms(10), 5).is_ok());
    for (now, at, counts) in [
        (Time::from_us(12_001), ms(10), 6),
        (ms(13), ms(13), 15_001),
        (ms(14), ms(14), -15_001),
        (ms(15), ms(15), i32::MAX),
    ] {
        assert_eq!(read(&mut one, now, at, counts), Err(Fault::Encoder));
        assert!(read(&mut one, ms(16), ms(16), 0).is_ok());
    }
    // The same word is a place for 20 ms.
    for time in 100..=120 {
        assert!(read(&mut one, ms(time), ms(time), 77).is_ok(), "{time}");
    }
    assert_eq!(read(&mut one, ms(121), ms(121), 77), Err(Fault::Encoder));
    assert!(read(&mut one, ms(122), ms(122), 78).is_ok());
    let mut settings = settings();
    settings.position_command.sensor_frozen_s = 0.0;
    let mut coarse = drive(settings);
    for time in 0..1000 {
        assert!(read(&mut coarse, ms(time), ms(time), 77).is_ok(), "{time}");
    }
}

#[test]
fn command_leads_by_delay_half_a_round_and_lag() {
    let moving = Setpoint {
        offset_mm: 0.01,
        speed_mm_s: 5.0,
        acceleration_mm_s2: 100.0,
    };
    // By hand, 0.1 ms + 0.5 ms later: 10 µm + 3 µm + 0.018 µm, at 5.06 mm/s: 10.12 µm of lag, and
    // 0.1 µm by the acceleration.
    let part = (10.0 + 3.018 + 10.12 + 0.1) / 200.0;
    let mut along = drive(settings());
    along.follow(ms(1), moving).unwrap();
    let found = commanded(&mut along);
    assert!((found - word(0.25 + part)).abs() <= 0.5, "{found}");
    let mut against = drive(DriveSettings {
        motor_reversed: true,
        ..settings()
    });
    against.follow(ms(1), moving).unwrap();
    let found = commanded(&mut against);
    assert!((found - word(0.25 - part)).abs() <= 0.5, "{found}");
}

#[test]
fn command_stays_within_its_limits() {
    let mut limited = settings();
    limited.position_command.max_command = 0.5;
    let mut drive = drive(limited);
    for (offset_mm, command) in [(1.0, 0.5), (-1.0, -0.5), (1e30, 0.5)] {
        drive.follow(ms(1), resting(offset_mm)).unwrap();
        let found = commanded(&mut drive);
        assert!((found - word(command)).abs() <= 0.5, "{found}");
    }
    assert_eq!(drive.follow(ms(2), resting(f32::NAN)), Err(Fault::Drive));
    assert!(!drive.is_powered() && drive.output_mut().word.is_none());
}

/// Follows a place for some rounds while the stage stands at another, and returns the correction of
/// the command, µm.
fn corrected_um(drive: &mut Drive, rounds: u32, behind_um: f32) -> f32 {
    for round in 0..rounds {
        // Noise of a count about the place.
        let noise = if round % 2 == 0 { 1 } else { -1 };
        #[expect(clippy::cast_possible_truncation, reason = "some thousand counts")]
        let counts = 1000 - (100.0 * behind_um) as i32 + noise;
        read(drive, ms(round), ms(round), counts).unwrap();
        drive.follow(ms(round), resting(0.0)).unwrap();
    }
    let command = 2.0 * commanded(drive) / f32::from(FULL) - 1.0;
    200.0 * (command - 0.25)
}

#[test]
fn correction_takes_up_the_following_error_at_its_rate_and_no_farther_than_its_limit() {
    // One step of the output is 0.1 µm.
    let mut one = drive(settings());
    let found = corrected_um(&mut one, 11, 2.0);
    assert!((found - 10.0 * 2.0 * 100.0 * 1e-3).abs() < 0.15, "{found}");
    let found = corrected_um(&mut drive(settings()), 200, 2.0);
    assert!((found - 5.0).abs() < 0.15, "{found}");
    let found = corrected_um(&mut drive(settings()), 200, -2.0);
    assert!((found + 5.0).abs() < 0.15, "{found}");
    // A stage that is released begins afresh.
    one.release();
    let found = corrected_um(&mut one, 1, 2.0);
    assert!(found.abs() < 0.15, "{found}");
}

#[test]
fn correction_stands_still_at_the_limit_of_the_command_unless_it_leads_back() {
    for motor_reversed in [false, true] {
        // For 10 rounds, with 100 per second: the error is as much of a correction.
        for (behind_um, expected_um) in [(2.0, 0.0), (-2.0, -2.0)] {
            let mut limited = DriveSettings {
                motor_reversed,
                ..settings()
            };
            limited.position_command.max_command = 0.5;
            limited.position_command.sensor_most_counts = 30_000.0;
            let mut drive = drive(limited);
            // Beyond the reach of the command, either way.
            for round in 0..=10 {
                #[expect(clippy::cast_possible_truncation, reason = "some thousand counts")]
                let counts = 1000 + (100.0 * (200.0 - behind_um)) as i32;
                read(&mut drive, ms(round), ms(round), counts).unwrap();
                drive.follow(ms(round), resting(0.2)).unwrap();
            }
            drive.follow(ms(11), resting(0.0)).unwrap();
            let command = 2.0 * commanded(&mut drive) / f32::from(FULL) - 1.0;
            let along = if motor_reversed { -1.0 } else { 1.0 };
            let found = along * 200.0 * (command - 0.25);
            assert!(
                (found - expected_um).abs() < 0.15,
                "{found}, {motor_reversed}"
            );
        }
    }
}

#[test]
fn output_that_fails_releases_and_a_failed_release_is_told_by_the_next_set_point() {
    let mut drive = drive(settings());
    drive.output_mut().fails = true;
    assert_eq!(drive.follow(ms(1), resting(0.0)), Err(Fault::Drive));
    assert!(!drive.is_powered());
    drive.output_mut().fails = false;
    assert_eq!(drive.follow(ms(2), resting(0.0)), Ok(()));
    assert!(drive.is_powered());
    drive.output_mut().release_fails = true;
    drive.release();
    drive.output_mut().release_fails = false;
    assert_eq!(drive.follow(ms(3), resting(0.0)), Err(Fault::Drive));
    assert_eq!(drive.follow(ms(4), resting(0.0)), Ok(()));
}

#[test]
fn settings_of_a_motor_leave_command_and_sensor_as_they_are() {
    let mut drive = drive(settings());
    assert!(drive.is_of(DriveKind::PositionCommand) && !drive.is_of(DriveKind::Motor));
    drive.set_settings(DriveSettings::default()).unwrap();
    let reading = read(&mut drive, ms(1), ms(1), 3000).unwrap();
    assert!((reading.offset_mm - 0.02).abs() < 1e-8, "{reading:?}");
    let mut wider = settings();
    wider.encoder_step_um = 0.02;
    drive.set_settings(wider).unwrap();
    let reading = read(&mut drive, ms(2), ms(2), 3000).unwrap();
    assert!((reading.offset_mm - 0.04).abs() < 1e-8, "{reading:?}");
    // The place at which a stage stands is not its zero.
    drive.set_reference();
    assert_eq!(
        read(&mut drive, ms(3), ms(3), 3000),
        Ok(StageReading {
            time: Time::from_us(2700),
            ..reading
        })
    );
}

#[test]
fn setting_out_of_range_is_refused_by_name() {
    let refused = |change: fn(&mut PositionCommandSettings)| {
        let mut settings = settings();
        change(&mut settings.position_command);
        settings.checked().unwrap_err().quantity.name()
    };
    assert_eq!(
        refused(|it| it.command_travel_um = 0.0),
        "command_travel_um"
    );
    assert_eq!(refused(|it| it.command_zero = f32::NAN), "command_zero");
    assert_eq!(
        refused(|it| {
            it.command_zero = 0.5;
            it.max_command = 0.5;
        }),
        "command_zero"
    );
    assert_eq!(refused(|it| it.lag_s = -1e-3), "lag_s");
    assert_eq!(refused(|it| it.sensor_frozen_s = 11.0), "sensor_frozen_s");
}

#[test]
fn what_only_a_motor_has_does_not_count() {
    let checked = DriveSettings {
        play_um: 7.0,
        index_mm: Some(0.3),
        ..settings()
    }
    .checked()
    .unwrap();
    assert_eq!((checked.play_um, checked.index_mm), (0.0, None));
    assert!(checked.is_absolute() && !DriveSettings::default().is_absolute());
}
