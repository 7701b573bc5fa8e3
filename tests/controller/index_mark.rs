//! The index mark: counts that are lost or added between two crossings of it.

use fmc_camera::CameraParameters;
use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::controller::{ControllerError, Start};
use fmc_camera::flight::drive::settings::{DriveSettings, EncoderSide};
use fmc_camera::flight::event::{Action, Command, Event};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{Flag, Outcome, Reason};
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::RunUp;

use crate::controller::bench::{Bench, acted, camera, exposed, identified};

/// σ of a record whose encoder has agreed with the mark, and of an encoder without errors of its
/// own: a fifth of a step and of five σ of the mark.
const REFERENCED_MM: f32 = 1e-4 * (1.0 + 1.0) / 5.0;

/// Largest loss in one step that the watch of the stage lets pass with the default settings: half
/// as much again as the jump tolerance of 1 µm, four times while the stage accelerates, and the
/// 5 µm by which friction moves it.
const UNSEEN_MM: f32 = 1.5 * (0.005 + 4.0 * 0.001);

fn with_mark(index_mm: f32) -> FlightSettings {
    FlightSettings {
        drive: DriveSettings {
            index_mm: Some(index_mm),
            ..DriveSettings::default()
        },
        ..FlightSettings::default()
    }
}

/// Takes a frame, and lets the stage return.
fn fly_frame(bench: &mut Bench) {
    bench.send(Event::Trigger);
    bench.run(250);
}

fn flags_of(bench: &Bench) -> Vec<bool> {
    let records = bench.records();
    records
        .iter()
        .map(|record| record.flags.contains(Flag::Unreferenced))
        .collect()
}

#[test]
fn every_cycle_crosses_the_mark_wherever_it_is_and_however_the_stage_moves() {
    for (direction, run_up) in [
        (FlightDirection::Forward, RunUp::Centred),
        (FlightDirection::Reverse, RunUp::Centred),
        (FlightDirection::Forward, RunUp::FromRest),
        (FlightDirection::Reverse, RunUp::FromRest),
    ] {
        for index_mm in [-1.9, -0.6, -0.05, 0.0, 0.1, 0.7, 1.9] {
            let mut parameters: CameraParameters = camera();
            if let Mechanism::Stage { run_up: it, .. } = &mut parameters.mechanism {
                *it = run_up;
            }
            let settings = FlightSettings {
                direction,
                ..with_mark(index_mm)
            };
            let mut bench = Bench::with(&parameters, settings, Start::Orderly);
            bench.arm();
            for vh_per_s in [0.1, 0.17, 0.05, 0.05, 0.1] {
                bench.vh_per_s = Some(vh_per_s);
                bench.run(1000);
                fly_frame(&mut bench);
            }
            let case = format!("{direction:?} {run_up:?} {index_mm}");
            assert_eq!(bench.records().len(), 5, "{case}");
            for record in bench.records() {
                assert_eq!(record.faults, Faults::NONE, "{case}");
                let sigma = exposed(&record).principal_point_sigma;
                assert!(sigma.common_mm >= REFERENCED_MM, "{case}: {sigma:?}");
            }
            // The first cycle at another V/H may miss the mark, and is told from the others.
            let flags = flags_of(&bench);
            assert!(!flags[0] && !flags[3], "{case}: {flags:?}");
            let found_mm = bench.camera.controller().index_mm().unwrap();
            assert!((found_mm - index_mm).abs() < 1e-4, "{case}: {found_mm}");
        }
    }
}

#[test]
fn counts_that_are_added_are_a_fault_at_the_next_crossing_and_doubt_the_records_since() {
    for added_mm in [-0.9, -0.3, -0.01, -0.0004, 0.0004, 0.0013, 0.02, 0.3, 0.9] {
        let mut bench = Bench::new(with_mark(-0.05));
        bench.arm();
        fly_frame(&mut bench);
        fly_frame(&mut bench);
        assert_eq!(flags_of(&bench), [false, false]);
        bench.camera.controller_mut().acknowledge(1);
        // The run-up crosses the mark, and counts are added after that.
        bench.send(Event::Trigger);
        bench.run_until(100, |state| state == State::Exposing);
        bench.added_mm = added_mm;
        bench.run(200);
        assert!(!flags_of(&bench)[0], "{added_mm}");
        // If many are lost, the run-up does not cross the mark, and it is searched for.
        bench.send(Event::Trigger);
        bench.run_until(1000, |state| state == State::Fault(Fault::Encoder));
        bench.run(200);
        let exposures = bench.camera.controller().in_doubt().unwrap();
        let is_told = |action: &Action| matches!(action, Action::InDoubt(it) if it.is_fault);
        let mut actions = bench.actions.iter();
        assert!(actions.any(|(_, it)| is_told(it)), "{added_mm}");
        assert_eq!(exposures.from_sequence, 3, "{added_mm}");
        assert!((exposures.off_mm - added_mm).abs() < 1e-4, "{exposures:?}");
        let records = bench.records();
        assert_eq!(flags_of(&bench)[..2], [false, true], "{added_mm}");
        assert!(!records[0].faults.contains(Fault::Encoder));
        assert!(records[1].faults.contains(Fault::Encoder));
        let sigma = exposed(&records[1]).principal_point_sigma;
        assert!(sigma.total_mm() > 0.9 * added_mm.abs(), "{sigma:?}");
        let is_refused = records[2].outcome == Outcome::Refused(Reason::Fault(Fault::Encoder));
        assert!(is_refused || flags_of(&bench)[2], "{added_mm}");
        assert!(bench.camera.controller().is_place_lost());
    }
}

#[test]
fn counts_that_pass_the_mark_unseen_are_within_three_sigma() {
    for added_um in [0.01, 0.05, 0.1, 0.15, 0.19, 0.25, 0.3, 0.5, 5.0] {
        for sign in [-1.0, 1.0] {
            let mut bench = Bench::new(with_mark(0.0));
            bench.arm();
            fly_frame(&mut bench);
            bench.added_mm = sign * 1e-3 * added_um;
            for _ in 0..3 {
                fly_frame(&mut bench);
            }
            let is_seen = bench.camera.controller().is_place_lost();
            for record in bench.records().iter().skip(1) {
                let sigma_mm = exposed(record).principal_point_sigma.total_mm();
                let is_covered = 1e-3 * added_um <= 3.0 * sigma_mm;
                assert!(is_seen || is_covered, "{added_um}: σ {sigma_mm}");
            }
        }
    }
}

#[test]
fn mark_that_is_crossed_in_an_exposure_or_just_after_doubts_its_record() {
    for index_mm in (0..16_u8).map(|step| 0.004 * f32::from(step)) {
        for added_mm in [-0.002, 0.0013] {
            let mut bench = Bench::new(with_mark(index_mm));
            bench.arm();
            fly_frame(&mut bench);
            bench.send(Event::Trigger);
            bench.run_until(100, |state| state == State::Tracking);
            bench.added_mm = added_mm;
            bench.run(300);
            let record = bench.records()[1];
            let case = format!("{index_mm} {added_mm}");
            assert!(record.faults.contains(Fault::Encoder), "{case}");
            assert!(record.flags.contains(Flag::Unreferenced), "{case}");
            let sigma_mm = exposed(&record).principal_point_sigma.total_mm();
            assert!(sigma_mm > 0.9 * added_mm.abs(), "{case}: {sigma_mm}");
        }
    }
}

#[test]
fn counts_that_are_lost_in_standby_are_found_at_arming() {
    for added_mm in [-0.9, -0.002, 0.002, 0.5] {
        let mut bench = Bench::new(with_mark(0.3));
        bench.run(200);
        bench.added_mm = added_mm;
        bench.send(Event::Command(Command::Arm));
        bench.run_until(2000, |state| state == State::Fault(Fault::Encoder));
        bench.run_until(200, |state| state == State::Degraded(Fault::Encoder));
        assert_eq!(bench.camera.controller().in_doubt(), None);
    }
}

#[test]
fn camera_that_does_not_find_its_mark_does_not_arm() {
    let mut bench = Bench::new(with_mark(0.0));
    bench.index_is_seen = false;
    bench.run(2);
    bench.send(Event::Command(Command::Arm));
    bench.run(1500);
    assert_eq!(bench.camera.controller().state(), State::Standby);
    assert!(acted(&bench, Action::Fault(Fault::IndexMark)));
    assert!(acted(&bench, Action::ReleaseStage));
    bench.index_is_seen = true;
    bench.arm();
}

#[test]
fn mark_that_is_no_longer_seen_leaves_records_unreferenced_and_costs_no_frame() {
    for index_mm in [0.0, 1.5] {
        let mut bench = Bench::new(with_mark(index_mm));
        bench.arm();
        fly_frame(&mut bench);
        bench.index_is_seen = false;
        for _ in 0..4 {
            fly_frame(&mut bench);
            bench.run(500);
        }
        assert_eq!(bench.camera.controller().state(), State::Armed);
        let faults = bench.actions.iter();
        let missed = faults.filter(|(_, it)| *it == Action::Fault(Fault::IndexMark));
        assert_eq!(missed.count(), 1, "it is reported once");
        let records = bench.records();
        assert!(
            records
                .iter()
                .any(|it| it.faults.contains(Fault::IndexMark))
        );
        // The way after the first frame has crossed the far mark for the second, whose counts no
        // crossing confirms.
        let is_far = index_mm > 1.0;
        assert_eq!(flags_of(&bench), [false, true, true, true, true]);
        // Each may have lost a step either way.
        let common_mm = |record: usize| exposed(&records[record]).principal_point_sigma.common_mm;
        for (record, cycles) in [(2, 2.0_f32), (3, 3.0), (4, 4.0)] {
            let cycles = if is_far { cycles - 1.0 } else { cycles };
            let expected = UNSEEN_MM * libm::sqrtf(cycles / 3.0);
            let found = common_mm(record);
            assert!(
                (found / expected - 1.0).abs() < 1e-3,
                "{found}, not {expected}"
            );
        }
        bench.index_is_seen = true;
        for _ in 0..2 {
            fly_frame(&mut bench);
        }
        assert_eq!(flags_of(&bench).last(), Some(&false), "{index_mm}");
    }
}

#[test]
fn camera_without_a_mark_says_so_in_every_record() {
    for encoder_side in [EncoderSide::Stage, EncoderSide::Screw] {
        let mut settings = FlightSettings::default();
        settings.drive.encoder_side = encoder_side;
        let mut bench = Bench::new(settings);
        bench.arm();
        for _ in 0..3 {
            fly_frame(&mut bench);
        }
        assert_eq!(flags_of(&bench), [true; 3]);
        let common_mm = |record: usize| {
            exposed(&bench.records()[record])
                .principal_point_sigma
                .common_mm
        };
        let growth = common_mm(2) / common_mm(0);
        assert!((growth - libm::sqrtf(3.0)).abs() < 1e-3, "{growth}");
    }
}

#[test]
fn mark_must_lie_inside_the_stroke_with_room_for_the_way_across_it() {
    let prepared =
        |index_mm| PreparedCamera::new(identified(&camera()), &with_mark(index_mm), Start::Orderly);
    // Half the stroke is 2 mm; a way across begins the play of 5 µm and twice the following
    // tolerance before the mark, 20 µm and what friction adds.
    for index_mm in [-1.973, 0.0, 1.973] {
        assert!(prepared(index_mm).is_ok(), "{index_mm}");
    }
    for index_mm in [-1.976, 1.976, 40.0, 60.0, f32::NAN] {
        let Err(ControllerError::Settings(error)) = prepared(index_mm) else {
            panic!("{index_mm}");
        };
        assert_eq!(error.quantity.name(), "index_mm");
        assert!(error.max > 1.97, "{error}");
    }
}
