//! Crossings of the index mark that a record waits for: what they show of the play, and what the
//! record says where they do not come.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::settings::EncoderSide;
use fmc_camera::flight::event::{Action, Command, Event};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{Flag, FrameRecord};
use fmc_camera::flight::settings::FlightSettings;

use crate::controller::bench::{Bench, exposed, settings};

const DIRECTIONS: [FlightDirection; 2] = [FlightDirection::Forward, FlightDirection::Reverse];

fn armed(direction: FlightDirection) -> Bench {
    let mut bench = Bench::new(FlightSettings {
        direction,
        ..settings()
    });
    bench.arm();
    bench
}

/// Takes a frame, and lets the stage return.
fn fly_frame(bench: &mut Bench) {
    bench.send(Event::Trigger);
    bench.run(250);
}

/// Takes a frame until its record is there, while the stage has not returned.
fn expose(bench: &mut Bench) {
    bench.send(Event::Trigger);
    bench.run_until(200, |state| state == State::FlyBack);
}

fn sigma_mm(record: &FrameRecord) -> f32 {
    exposed(record).principal_point_sigma.total_mm()
}

fn is_unreferenced(record: &FrameRecord) -> bool {
    record.flags.contains(Flag::Unreferenced)
}

fn doubts(bench: &Bench) -> usize {
    let actions = bench.actions.iter();
    actions
        .filter(|(_, action)| matches!(action, Action::InDoubt(_)))
        .count()
}

#[test]
fn play_that_grows_is_in_sigma_or_in_doubt_in_a_flight_against_the_axis() {
    for grown_mm in [0.003, 0.01, 0.1] {
        for rounds in [0, 20, 60, 100, 150, 250] {
            let mut bench = armed(FlightDirection::Reverse);
            fly_frame(&mut bench);
            fly_frame(&mut bench);
            bench.send(Event::Trigger);
            bench.run(rounds);
            bench.play_grown_mm = grown_mm;
            let grown = bench.now;
            bench.run(250 - rounds);
            for _ in 0..3 {
                fly_frame(&mut bench);
            }
            let case = format!("{grown_mm} mm after {rounds} rounds");
            let records = bench.records();
            assert_eq!(records.len(), 6, "{case}");
            for record in &records {
                let is_held = sigma_mm(record) > 0.9 * grown_mm;
                assert!(
                    is_held || exposed(record).closed < grown,
                    "{case}: {record:?}"
                );
            }
            // From the last crossing before it on.
            let flags: Vec<bool> = records.iter().map(is_unreferenced).collect();
            assert!(!flags[0] && !flags[3..].contains(&false), "{case}");
            assert_eq!(doubts(&bench), 1, "{case}");
            assert!(
                records.iter().all(|record| record.faults == Faults::NONE),
                "{case}"
            );
        }
    }
}

#[test]
fn play_that_grows_is_told_along_the_axis_and_unknown_with_the_encoder_on_the_stage() {
    for (direction, encoder_side) in [
        (FlightDirection::Forward, EncoderSide::Screw),
        (FlightDirection::Forward, EncoderSide::Stage),
        (FlightDirection::Reverse, EncoderSide::Stage),
    ] {
        let mut settings = FlightSettings {
            direction,
            ..settings()
        };
        settings.drive.encoder_side = encoder_side;
        let mut bench = Bench::new(settings);
        bench.arm();
        for frame in 0..5 {
            fly_frame(&mut bench);
            bench.play_grown_mm = if frame < 1 { 0.0 } else { 0.02 };
        }
        let records = bench.records();
        // It may be the encoder, too.
        let is_told = encoder_side == EncoderSide::Screw;
        assert_eq!(doubts(&bench), usize::from(is_told));
        let flags: Vec<bool> = records.iter().map(is_unreferenced).collect();
        assert_eq!(flags, [false, false, is_told, is_told, is_told]);
        let growth = sigma_mm(&records[4]) / sigma_mm(&records[1]);
        assert!((growth - 1.0).abs() < 1e-3, "{growth}");
    }
}

#[test]
fn growth_that_was_known_is_known_after_another_arming() {
    let mut bench = armed(FlightDirection::Reverse);
    fly_frame(&mut bench);
    bench.send(Event::Command(Command::Disarm));
    bench.run(10);
    bench.play_grown_mm = 0.02;
    bench.arm();
    fly_frame(&mut bench);
    let record = bench.records()[1];
    assert!(sigma_mm(&record) > 0.9 * 0.02, "{record:?}");
    assert!(is_unreferenced(&record));
}

#[test]
fn record_whose_next_crossing_never_comes_is_in_doubt() {
    for direction in DIRECTIONS {
        for fault in [Fault::Stall, Fault::Drive] {
            let mut bench = armed(direction);
            fly_frame(&mut bench);
            expose(&mut bench);
            let before = bench.records()[1];
            assert!(!is_unreferenced(&before), "{direction:?}");
            bench.send(Event::Drive(fault));
            let [first, last] = bench.records()[..] else {
                panic!();
            };
            assert!(
                !is_unreferenced(&first) && is_unreferenced(&last),
                "{direction:?}"
            );
            // 13.5 µm that the stage's watch lets pass at most.
            let lost_mm = 0.0135 / libm::sqrtf(3.0);
            let expected_mm = libm::hypotf(sigma_mm(&before), lost_mm);
            assert!((sigma_mm(&last) / expected_mm - 1.0).abs() < 1e-3);
            assert_eq!(doubts(&bench), 1, "{direction:?}");
            let exposures = bench.camera.controller().in_doubt().unwrap();
            assert!(!exposures.is_fault && exposures.from_sequence == 2);
        }
    }
}

#[test]
fn record_that_the_way_back_has_confirmed_is_not_in_doubt() {
    let mut bench = armed(FlightDirection::Forward);
    fly_frame(&mut bench);
    bench.send(Event::Drive(Fault::Drive));
    assert_eq!(doubts(&bench), 0);
    // Counts that were lost in the exposure show on the way back.
    let mut settings = settings();
    settings.drive.index_mm = Some(-0.05);
    let mut bench = Bench::new(settings);
    bench.arm();
    fly_frame(&mut bench);
    bench.send(Event::Trigger);
    bench.run_until(100, |state| state == State::Exposing);
    bench.added_mm = 0.002;
    bench.run(200);
    assert_eq!(doubts(&bench), 1);
    let record = bench.records()[1];
    assert!(is_unreferenced(&record) && sigma_mm(&record) > 0.9 * 0.002);
    assert_eq!(record.faults, Faults::NONE, "it may be the play");
}

#[test]
fn disarming_leaves_no_record_in_doubt() {
    for direction in DIRECTIONS {
        let mut bench = armed(direction);
        for _ in 0..3 {
            fly_frame(&mut bench);
        }
        bench.send(Event::Command(Command::Disarm));
        bench.run(300);
        assert_eq!(bench.camera.controller().state(), State::Standby);
        assert_eq!(doubts(&bench), 0, "{direction:?}");
    }
}

#[test]
fn mark_that_is_missed_in_one_direction_leaves_the_record_before_in_doubt() {
    // Against the axis in the frame: the play of its record is not confirmed.
    let mut bench = armed(FlightDirection::Reverse);
    fly_frame(&mut bench);
    bench.index_is_seen = false;
    expose(&mut bench);
    bench.index_is_seen = true;
    bench.run(250);
    let flags: Vec<bool> = bench.records().iter().map(is_unreferenced).collect();
    assert_eq!(flags, [false, true]);
    // In both: the next record says that nothing was compared, and the one before waits in vain.
    fly_frame(&mut bench);
    bench.index_is_seen = false;
    fly_frame(&mut bench);
    fly_frame(&mut bench);
    let flags: Vec<bool> = bench.records().iter().map(is_unreferenced).collect();
    assert_eq!(flags, [false, true, false, true, true]);
}

#[test]
fn record_that_the_way_back_has_confirmed_stays_when_the_mark_is_missed() {
    let mut bench = armed(FlightDirection::Forward);
    fly_frame(&mut bench);
    fly_frame(&mut bench);
    bench.index_is_seen = false;
    fly_frame(&mut bench);
    let flags: Vec<bool> = bench.records().iter().map(is_unreferenced).collect();
    assert_eq!(flags, [false, false, true]);
}
