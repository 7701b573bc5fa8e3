//! Frames that something interrupts: late rounds, missing readings, a stage that is moved by hand,
//! and commands to disarm.

use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::flight::time::Time;

use crate::controller::bench::{Bench, acted, camera, exposed, in_state, only, settings};

/// Half of the stroke, mm.
const HALF_STROKE_MM: f32 = 2.0;

fn state(bench: &Bench) -> State {
    bench.camera.controller().state()
}

/// Number of rounds from a trigger until the shutter is told to open.
fn rounds_of_run_up() -> u32 {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |state| state == State::Tracking)
}

/// Returns a camera with an exposure of 20 ms whose shutter has just opened.
fn exposing() -> Bench {
    let mut bench = Bench::new(FlightSettings {
        exposure_s: 0.02,
        ..settings()
    });
    bench.arm();
    bench.send(Event::Trigger);
    bench.run_until(100, |state| state == State::Exposing);
    bench
}

#[test]
fn round_that_is_late_when_the_shutter_is_to_open_ends_the_frame_with_an_overload() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(rounds_of_run_up() - 1);
    assert_eq!(state(&bench), State::RunUp);
    bench.now = bench.now.plus_s(0.004);
    bench.round();
    let record = only(&bench);
    let reason = Reason::Fault(Fault::Overload);
    assert_eq!(record.outcome, Outcome::Refused(reason));
    assert!(record.faults.contains(Fault::Overload));
    assert_eq!(state(&bench), State::FlyBack);
}

#[test]
fn shutter_stays_closed_over_a_stage_that_is_not_read_any_more() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(rounds_of_run_up() - 2);
    bench.is_read = false;
    bench.run(4);
    let opens = |(_, action): &(Time, Action)| matches!(action, Action::OpenShutter { .. });
    assert!(!bench.actions.iter().any(opens));
    bench.is_read = true;
    bench.run(50);
    assert_eq!(only(&bench).outcome, Outcome::Refused(Reason::NotAtSpeed));
}

#[test]
fn clock_that_jumps_after_last_light_leaves_the_planned_motion() {
    let mut bench = in_state(State::Exposing);
    bench.edges.clear();
    bench.run(2);
    bench.send(Event::Shutter(ShutterEdge::Closed));
    assert_eq!(state(&bench), State::Exposing);
    let closed = bench.now;
    bench.send_at(bench.now.plus_s(5.0), Event::Tick);
    let record = only(&bench);
    assert!(record.faults.contains(Fault::Clock));
    assert!(record.flags.contains(Flag::PlannedMotion));
    assert!(!record.flags.contains(Flag::LastLightAssumed));
    assert_eq!(exposed(&record).closed, closed);
    assert_eq!(state(&bench), State::Fault(Fault::Clock));
}

#[test]
fn last_light_that_is_not_after_first_light_is_no_edge_of_the_exposure() {
    let mut bench = in_state(State::Tracking);
    let (opened, _) = bench.edges[0];
    let (closed, _) = bench.edges[1];
    bench.run_until(10, |state| state == State::Exposing);
    for early_s in [0.0, 0.001] {
        let early = opened.plus_s(-early_s);
        bench.send_at(early, Event::Shutter(ShutterEdge::Closed));
    }
    assert_eq!(state(&bench), State::Exposing);
    assert_eq!(bench.camera.controller().counts().unexpected_edges, 2);
    bench.run(50);
    let record = only(&bench);
    assert!(record.faults.contains(Fault::ShutterUnexpected));
    assert_eq!(
        [exposed(&record).opened, exposed(&record).closed],
        [opened, closed]
    );
}

#[test]
fn glitch_between_two_frames_is_counted_and_in_the_record_of_neither() {
    let mut bench = Bench::armed();
    bench.now = bench.now.plus_s(1e-3);
    let reading = StageReading {
        time: bench.now,
        offset_mm: bench.place_mm() + 0.05,
    };
    bench.send(Event::Stage(reading));
    bench.send(Event::Tick);
    bench.run(5);
    assert_eq!(bench.camera.controller().counts().glitches, 1);
    bench.send(Event::Trigger);
    bench.run(100);
    assert!(!only(&bench).flags.contains(Flag::EncoderGlitch));
}

#[test]
fn exposure_of_a_stage_that_is_moved_out_of_its_stroke_is_as_of_a_standing_one() {
    let mut bench = exposing();
    bench.send(Event::LimitSwitch);
    assert_eq!(
        bench.camera.controller().setpoint(bench.now),
        None,
        "released"
    );
    for _ in 0..30 {
        bench.stage.offset_mm += 0.4;
        bench.round();
    }
    let record = only(&bench);
    for flag in [Flag::PlannedMotion, Flag::StaticCorrection] {
        assert!(record.flags.contains(flag));
    }
    let frame = exposed(&record);
    assert!(frame.interior.motion.centroid_mm.abs() <= 0.0);
    assert!(frame.interior.motion.travel_mm.abs() <= 0.0);
    let sigma = frame.principal_point_sigma;
    assert!((sigma.frame_mm - HALF_STROKE_MM).abs() < 1e-6, "{sigma:?}");
    assert!(sigma.common_mm.abs() <= 0.0, "its place is known");
}

#[test]
fn rows_that_were_clocked_beyond_the_stroke_are_as_standing_ones() {
    // 1000 mm at 0.0595 1/s for 1/30 s: 1.983 mm, of 2 mm.
    let mut calibration = camera().calibration;
    calibration.principal_distance_mm = 1000.0;
    calibration.exit_pupil_mm = 1000.0;
    let mut parameters = CameraParameters {
        mechanism: Mechanism::Tdi {
            first_transfer: 0.5,
        },
        calibration,
        ..camera()
    };
    parameters.limits.vh_per_s = [0.01, 0.06];
    let settings = FlightSettings {
        exposure_s: 1.0 / 30.0,
        ..FlightSettings::default()
    };
    for (longer_s, is_beyond) in [(0.0, false), (0.0009, true)] {
        let mut bench = Bench::with(&parameters, settings, Start::Orderly);
        bench.vh_per_s = Some(0.0595);
        bench.arm();
        bench.send(Event::Trigger);
        bench.run_until(100, |state| state == State::Tracking);
        let (closed, _) = bench.edges[1];
        bench.edges[1].0 = closed.plus_s(longer_s);
        bench.run(100);
        let record = only(&bench);
        assert_eq!(record.flags.contains(Flag::PlannedMotion), is_beyond);
        assert_eq!(record.flags.contains(Flag::StaticCorrection), is_beyond);
        let frame = exposed(&record);
        let travel_mm = frame.interior.motion.travel_mm;
        assert_eq!(travel_mm.abs() <= 0.0, is_beyond, "{travel_mm}");
        let frame_mm = frame.principal_point_sigma.frame_mm;
        assert_eq!((frame_mm - HALF_STROKE_MM).abs() < 1e-6, is_beyond);
    }
}

#[test]
fn exposure_whose_readings_cease_is_continued_for_three_milliseconds_and_planned_beyond() {
    for (read_before_end_ms, flag) in [(2.5, Flag::ExtrapolatedMotion), (4.5, Flag::PlannedMotion)]
    {
        let mut bench = exposing();
        // A stage that is released need not be read.
        bench.send(Event::LimitSwitch);
        let (closed, edge) = bench.edges[0];
        assert_eq!(edge, ShutterEdge::Closed);
        while 1e3 * closed.seconds_since(bench.now) > read_before_end_ms {
            bench.round();
        }
        bench.is_read = false;
        bench.run(30);
        let record = only(&bench);
        for other in [Flag::ExtrapolatedMotion, Flag::PlannedMotion] {
            assert_eq!(record.flags.contains(other), other == flag, "{other:?}");
        }
        assert!(exposed(&record).principal_point_sigma.frame_mm >= 0.01);
    }
}

#[test]
fn planned_motion_of_a_stepper_is_not_told_as_steps_that_nothing_measures() {
    let mechanism = Mechanism::Stage {
        acceleration_mm_s2: 1000.0,
        settling_ms: 5.0,
        run_up: RunUp::Centred,
        jerk_mm_s3: None,
        max_speed_mm_s: Some(20.0),
    };
    let mut parameters = CameraParameters {
        mechanism,
        ..camera()
    };
    parameters.limits.vh_per_s = [0.01, 0.2];
    let mut settings = FlightSettings::default();
    settings.drive.kind = DriveKind::Stepper;
    settings.drive.stepper.steps_per_mm = 1000.0;
    for is_read in [true, false] {
        let mut bench = Bench::with(&parameters, settings, Start::Orderly);
        bench.arm();
        bench.send(Event::Trigger);
        bench.run_until(100, |state| state == State::Exposing);
        bench.send(Event::LimitSwitch);
        bench.is_read = is_read;
        bench.run(50);
        let flags = only(&bench).flags;
        assert_eq!(flags.contains(Flag::NotMeasured), is_read);
        assert_eq!(flags.contains(Flag::PlannedMotion), !is_read);
    }
}

#[test]
fn camera_that_is_disarmed_in_an_exposure_without_force_goes_to_standby_after_it() {
    let mut bench = Bench::armed();
    bench.send(Event::LimitSwitch);
    bench.run_until(200, |it| it == State::Degraded(Fault::LimitSwitch));
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Exposing);
    bench.send(Event::Command(Command::Disarm));
    assert_eq!(state(&bench), State::Exposing);
    bench.run_until(100, |it| it == State::Standby);
    assert!(matches!(only(&bench).outcome, Outcome::Exposed(_)));
    bench.run(200);
    assert_eq!(state(&bench), State::Standby);
}

#[test]
fn record_whose_counts_no_crossing_confirms_before_the_force_is_off_is_in_doubt() {
    for is_seen in [true, false] {
        let mut bench = in_state(State::Exposing);
        bench.send(Event::Command(Command::Disarm));
        bench.index_is_seen = is_seen;
        bench.run_until(500, |it| it == State::Standby);
        assert!(acted(&bench, Action::ReleaseStage));
        let doubts = bench.actions.iter().filter_map(|(_, action)| match action {
            Action::InDoubt(exposures) => {
                Some([exposures.from_sequence, exposures.through_sequence()])
            }
            _ => None,
        });
        let expected: &[[u32; 2]] = if is_seen { &[] } else { &[[1, 1]] };
        assert_eq!(doubts.collect::<Vec<_>>(), expected);
        assert_eq!(only(&bench).flags.contains(Flag::Unreferenced), !is_seen);
    }
}

#[test]
fn mark_that_was_missed_in_flight_is_not_reported_again_by_the_exercise_after_a_fault() {
    let mut bench = Bench::armed();
    bench.index_is_seen = false;
    for _ in 0..4 {
        bench.send(Event::Trigger);
        bench.run(1000);
    }
    let missed = |bench: &Bench| {
        let faults = bench.actions.iter();
        faults
            .filter(|(_, it)| *it == Action::Fault(Fault::IndexMark))
            .count()
    };
    assert_eq!((state(&bench), missed(&bench)), (State::Armed, 1));
    bench.send(Event::Supply(Supply::Low));
    bench.send(Event::Supply(Supply::Good));
    bench.run_until(3000, |it| it == State::Armed);
    assert_eq!(missed(&bench), 1);
}

#[test]
fn camera_waits_in_a_fault_until_its_released_stage_has_stood() {
    let mut bench = Bench::armed();
    bench.send(Event::LimitSwitch);
    for _ in 0..20 {
        // Pushed by hand, before it has stood for 50 ms.
        bench.stage.offset_mm += 0.1;
        bench.run(40);
        assert_eq!(state(&bench), State::Fault(Fault::LimitSwitch));
    }
    let rounds = bench.run_until(100, |it| it == State::Degraded(Fault::LimitSwitch));
    assert!((5..=15).contains(&rounds), "{rounds}");
}
