//! A stage with an absolute sensor, which has its place at any time.

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::event::{Action, Command, Event, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Outcome};
use fmc_camera::flight::rig::Rig;
use fmc_camera::flight::settings::FlightSettings;

use super::bench::{Bench, camera, only, settings};

/// Returns the settings of a stage with an absolute sensor; index mark and play do not count.
fn absolute() -> FlightSettings {
    let mut absolute = settings();
    absolute.encoder_survives_brown_out = false;
    absolute.drive.kind = DriveKind::PositionCommand;
    absolute
}

fn started(start: Start) -> Bench {
    let mut bench = Bench::with(&camera(), absolute(), start);
    // The sensor is read in a place of its own, and nothing crosses a mark.
    bench.index_is_seen = false;
    bench.run(100);
    bench
}

fn exposed(bench: &Bench) -> ExposedFrame {
    let Outcome::Exposed(frame) = only(bench).outcome else {
        panic!("{:?}", only(bench));
    };
    frame
}

fn is_place_lost(bench: &Bench) -> bool {
    bench.camera.controller().is_place_lost()
}

/// Sends a trigger, and waits for its record.
fn trigger(bench: &mut Bench) {
    bench.send(Event::Trigger);
    bench.run(100);
}

#[test]
fn after_any_start_the_stage_compensates_without_reference_or_mark() {
    for start in [Start::Orderly, Start::Unreferenced, Start::AfterWatchdog] {
        let mut bench = started(start);
        assert!(!is_place_lost(&bench), "{start:?}");
        bench.send(Event::Command(Command::ClearFault));
        bench.arm();
        trigger(&mut bench);
        let record = only(&bench);
        let flags: Vec<Flag> = record.flags.iter().collect();
        assert_eq!(flags, [], "{start:?}");
        assert!(!bench.actions.iter().any(|(_, action)| matches!(
            action,
            Action::InDoubt(_) | Action::Fault(Fault::IndexMark)
        )));
    }
    // An encoder that counts has lost its place with the same starts.
    for start in [Start::Unreferenced, Start::AfterWatchdog] {
        let bench = Bench::with(&camera(), settings(), start);
        assert!(is_place_lost(&bench), "{start:?}");
    }
}

#[test]
fn sigma_is_that_of_step_noise_zero_scale_and_age_and_does_not_grow() {
    let mut settings = absolute();
    settings.drive.position_command.sensor_noise_um = 0.3;
    settings.drive.zero_sigma_um = 0.2;
    settings.drive.encoder_scale_ppm = 1000.0;
    settings.drive.reading_age_sigma_s = 1e-5;
    let mut bench = Bench::with(&camera(), settings, Start::Unreferenced);
    bench.arm();
    for _ in 0..20 {
        trigger(&mut bench);
    }
    let records = bench.records();
    assert_eq!(records.len(), 20);
    for record in records {
        let Outcome::Exposed(frame) = record.outcome else {
            panic!("{record:?}");
        };
        let sigma = frame.principal_point_sigma;
        let speed_um_s = 1e3 * frame.interior.motion.travel_mm / frame.interior.exposure_s;
        let scale_um = 1e-3 * 1e3 * frame.interior.motion.centroid_mm;
        let squares = [0.1 / libm::sqrtf(12.0), 0.2, scale_um, speed_um_s * 1e-5].map(|it| it * it);
        let common_um = libm::sqrtf(squares.into_iter().sum());
        assert!(
            (1e3 * sigma.common_mm - common_um).abs() < 2e-3,
            "{sigma:?}"
        );
        // The mean over the 3.33 rounds of an exposure.
        let frame_um = 1e3 * sigma.frame_mm;
        let expected_um = 0.3 / libm::sqrtf(3.333);
        assert!((frame_um - expected_um).abs() < 5e-3, "{sigma:?}");
    }
}

#[test]
fn sensor_that_fails_is_not_believed_until_the_fault_is_cleared() {
    let mut bench = started(Start::Orderly);
    bench.arm();
    bench.send(Event::Drive(Fault::Encoder));
    bench.run_until(200, |state| state == State::Degraded(Fault::Encoder));
    assert!(is_place_lost(&bench));
    trigger(&mut bench);
    assert!(only(&bench).flags.contains(Flag::PlannedMotion));
    let half_stroke_mm = 0.5 * camera().calibration.stroke_mm;
    let sigma = exposed(&bench).principal_point_sigma;
    assert!(sigma.total_mm() >= half_stroke_mm, "{sigma:?}");
    bench.send(Event::Command(Command::ClearFault));
    assert!(!is_place_lost(&bench));
    bench.arm();
    trigger(&mut bench);
    let record = bench.records()[1];
    assert!(record.flags.iter().next().is_none(), "{record:?}");
}

#[test]
fn low_supply_and_release_leave_the_place_known() {
    let mut bench = started(Start::Orderly);
    bench.arm();
    bench.send(Event::Supply(Supply::Low));
    bench.run(50);
    assert!(!is_place_lost(&bench));
    bench.send(Event::Supply(Supply::Good));
    bench.run_until(2000, |state| state == State::Armed);
    bench.send(Event::Command(Command::Disarm));
    bench.run(100);
    assert!(!is_place_lost(&bench));
    let mut counting = settings();
    counting.encoder_survives_brown_out = false;
    let mut bench = Bench::new(counting);
    bench.arm();
    bench.send(Event::Supply(Supply::Low));
    assert!(is_place_lost(&bench));
}

#[test]
fn flight_over_a_reset_is_measured_without_force_until_the_fault_is_cleared() {
    let mut bench = started(Start::FliesOn);
    bench.run_until(200, |state| state == State::Degraded(Fault::Watchdog));
    assert!(!is_place_lost(&bench));
    trigger(&mut bench);
    assert!(bench.camera.controller().setpoint(bench.now).is_none());
    let record = only(&bench);
    assert!(record.flags.contains(Flag::NoCompensation), "{record:?}");
    assert!(!record.flags.contains(Flag::PlannedMotion), "{record:?}");
    let sigma = exposed(&bench).principal_point_sigma;
    assert!(sigma.total_mm() < 1e-4, "{sigma:?}");
    bench.send(Event::Command(Command::ClearFault));
    bench.arm();
    trigger(&mut bench);
    assert!(bench.records()[1].flags.iter().next().is_none());
}

#[test]
fn flight_with_an_absolute_sensor_does_not_refer_an_encoder_that_counts() {
    for (start, is_lost) in [(Start::Unreferenced, true), (Start::Orderly, false)] {
        let mut rig = Rig::new(start);
        rig.load(Camera::new(camera()).unwrap());
        let lost = |rig: &Rig| rig.controller().unwrap().is_place_lost();
        for _ in 0..2 {
            rig.prepare(&absolute()).unwrap();
            assert!(!lost(&rig));
        }
        rig.prepare(&settings()).unwrap();
        assert_eq!(lost(&rig), is_lost);
    }
}

#[test]
fn command_or_sensor_that_ends_inside_the_stroke_is_refused_by_name() {
    let refused = |change: fn(&mut FlightSettings)| {
        let mut settings = absolute();
        change(&mut settings);
        let mut rig = Rig::new(Start::Orderly);
        rig.load(Camera::new(camera()).unwrap());
        rig.prepare(&settings).unwrap_err().to_string()
    };
    let told = refused(|it| it.drive.position_command.command_travel_um = 1999.0);
    assert!(
        told.contains("command_travel_um = 1999 is outside 2000 to"),
        "{told}"
    );
    let told = refused(|it| it.drive.position_command.max_command = 0.7);
    assert!(told.contains("command_travel_um"), "{told}");
    let told = refused(|it| it.drive.position_command.sensor_most_counts = 19_999.0);
    assert!(
        told.contains("sensor_zero_counts = 0 is outside -12000 to -1"),
        "{told}"
    );
}
