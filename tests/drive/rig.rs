//! The drive of a rig: an amplifier with an absolute sensor, and a stepper, as numbers.

use fmc_camera::flight::drive::FmcDrive;
use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::position_command_settings::PositionCommandSettings;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::step_settings::StepSettings;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

fn at(offset_mm: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        ..Setpoint::default()
    }
}

fn place_mm(drive: &mut RigDrive) -> f32 {
    drive.position(Time::START).unwrap().offset_mm
}

/// Stage of ±100 µm whose sensor has 10 nm per count, and count 1000 at the calibrated position.
fn absolute() -> DriveSettings {
    DriveSettings {
        kind: DriveKind::PositionCommand,
        encoder_step_um: 0.01,
        position_command: PositionCommandSettings {
            command_travel_um: 200.0,
            command_zero: 0.25,
            sensor_zero_counts: 1000.0,
            ..PositionCommandSettings::UNUSED
        },
        ..DriveSettings::default()
    }
}

fn stepped() -> DriveSettings {
    DriveSettings {
        kind: DriveKind::Stepper,
        stepper: StepSettings {
            steps_per_mm: 1000.0,
            ..StepSettings::default()
        },
        ..DriveSettings::default()
    }
}

#[test]
fn amplifier_shows_its_command_and_its_sensor_keeps_its_zero() {
    let mut drive = RigDrive::new(absolute()).unwrap();
    assert!(drive.is_of(DriveKind::PositionCommand) && !drive.is_of(DriveKind::Motor));
    drive.set_count(3000);
    assert!((place_mm(&mut drive) - 0.02).abs() < 1e-8);
    // The zero of the sensor is a setting, and the mechanism has no index mark.
    drive.set_position(7);
    drive.set_reference();
    drive.set_index(Some(3000));
    assert!((place_mm(&mut drive) - 0.02).abs() < 1e-8);
    assert_eq!(drive.take_index(), None);
    assert!(!drive.powered());
    drive.follow(Time::START, at(0.05)).unwrap();
    assert!(drive.powered());
    // 50 µm of 200 µm beyond the zero of the command.
    assert!((drive.duty() - 0.5).abs() < 1e-4, "{}", drive.duty());
    drive.release();
    assert!(!drive.powered());
    let mut coarser = absolute();
    coarser.encoder_step_um = 0.02;
    drive.set_settings(coarser).unwrap();
    assert!((place_mm(&mut drive) - 0.04).abs() < 1e-8);
}

#[test]
fn stepper_shows_its_steps_in_parts_of_the_pulses_of_a_round() {
    let mut drive = RigDrive::new(stepped()).unwrap();
    assert!(drive.is_of(DriveKind::Stepper) && !drive.is_of(DriveKind::Motor));
    drive.follow(Time::START, at(0.008)).unwrap();
    assert!(drive.powered());
    // 8 steps of 40 pulses.
    assert!((drive.duty() - 0.2).abs() < 1e-6, "{}", drive.duty());
    assert!((place_mm(&mut drive) - 0.008).abs() < 1e-8);
    drive.follow(Time::START, at(0.002)).unwrap();
    assert!((drive.duty() + 0.15).abs() < 1e-6, "{}", drive.duty());
    drive.release();
    assert!(!drive.powered() && drive.duty().abs() <= 0.0);
}

#[test]
fn duty_is_refused_by_what_has_no_motor_of_its_own() {
    for settings in [absolute(), stepped()] {
        let mut drive = RigDrive::new(settings).unwrap();
        assert_eq!(drive.asked_duty(), None);
        drive.follow(Time::START, at(0.001)).unwrap();
        assert!(drive.powered());
        assert_eq!(drive.push(Time::START, 0.1), Err(Fault::Drive));
        assert!(!drive.powered(), "{:?}", settings.kind);
    }
}

#[test]
fn other_settings_and_another_zero_release_the_stepper() {
    let powered = || {
        let mut drive = RigDrive::new(stepped()).unwrap();
        drive.follow(Time::START, at(0.008)).unwrap();
        assert!(drive.powered());
        drive
    };
    let mut drive = powered();
    drive.set_settings(stepped()).unwrap();
    assert!(!drive.powered() && drive.duty().abs() <= 0.0);
    assert!((place_mm(&mut drive) - 0.008).abs() < 1e-8);
    let mut drive = powered();
    let mut wrong = stepped();
    wrong.stepper.steps_per_mm = f32::NAN;
    assert!(drive.set_settings(wrong).is_err());
    assert!(drive.powered(), "nothing has changed");
    let mut drive = powered();
    drive.set_reference();
    assert!(!drive.powered() && drive.duty().abs() <= 0.0);
    assert!(place_mm(&mut drive).abs() <= 0.0);
}

#[test]
fn settings_that_no_drive_can_have_are_an_error_that_names_the_field() {
    let motor = DriveSettings::default();
    for (settings, name) in [
        (motor, "motor"),
        (absolute(), "amplifier"),
        (stepped(), "stepper"),
    ] {
        assert!(RigDrive::new(settings).is_ok(), "{name}");
        let wrong = DriveSettings {
            encoder_step_um: f32::NAN,
            ..settings
        };
        let error = RigDrive::new(wrong).err().unwrap();
        assert!(error.to_string().contains("encoder"), "{name}: {error}");
    }
}
