//! Every fault of the first set has the outcome that its scenario states, and never a silent wrong coordinate.

use std::collections::BTreeSet;

use fmc_camera::flight::frame_record::{Flag, Outcome};
use host_sim::mission::fault::InjectedFault;

use crate::support::{fault_scenario, folder, passed};

#[test]
fn there_is_a_scenario_for_every_fault() {
    let mut with_scenario = BTreeSet::new();
    for entry in std::fs::read_dir(folder().join("faults")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        for fault in &fault_scenario(name).faults {
            with_scenario.insert(fault.injection.fault);
        }
    }
    assert!(
        with_scenario
            .iter()
            .eq(BTreeSet::from(InjectedFault::ALL).iter())
    );
}

#[test]
fn silent_source_is_bridged_then_flown_without() {
    let (flown, _) = passed(&fault_scenario("vh-drop-out"), 1);
    // First the last good V/H, then no compensation; every trigger is exposed.
    let has = |flag| {
        flown
            .frames
            .iter()
            .position(|frame| frame.record.flags.contains(flag))
    };
    assert!(has(Flag::LastGoodVh).unwrap() < has(Flag::NoCompensation).unwrap());
}

#[test]
fn jump_of_vh_is_not_believed() {
    let (_, judgement) = passed(&fault_scenario("vh-jump"), 1);
    // As sharp as without the jump: 30 % of 4.6 px would show.
    for errors in judgement.errors.iter().flatten() {
        assert!(errors.smear_px < 0.25, "{errors:?}");
    }
}

#[test]
fn vh_that_is_no_number_is_not_believed() {
    passed(&fault_scenario("vh-nan"), 1);
}

#[test]
fn frozen_vh_is_not_believed_for_ever() {
    passed(&fault_scenario("vh-frozen"), 1);
}

#[test]
fn vh_in_knots_is_not_believed() {
    let (_, judgement) = passed(&fault_scenario("vh-wrong-unit"), 1);
    for errors in judgement.errors.iter().flatten() {
        assert!(errors.smear_px < 0.25, "{errors:?}");
    }
}

#[test]
fn vh_of_the_wrong_sign_is_not_believed() {
    let (_, judgement) = passed(&fault_scenario("vh-wrong-sign"), 1);
    for errors in judgement.errors.iter().flatten() {
        assert!(errors.smear_px < 0.25, "{errors:?}");
    }
}

#[test]
fn stall_is_caught_within_five_ms_and_the_next_frames_stand_still() {
    let (flown, judgement) = passed(&fault_scenario("stall"), 1);
    for (frame, errors) in flown.frames.iter().zip(&judgement.errors) {
        if frame.record.flags.contains(Flag::NoCompensation) {
            // f·η·t = 4.6 px, all of it.
            assert!(errors.unwrap().smear_px > 4.0);
        }
    }
}

#[test]
fn swapped_wires_of_the_motor_are_caught_within_five_ms() {
    passed(&fault_scenario("sign-error"), 1);
}

#[test]
fn swapped_wires_of_the_encoder_are_caught_within_five_ms() {
    passed(&fault_scenario("sign-error-encoder"), 1);
}

#[test]
fn stage_that_runs_away_is_let_go() {
    passed(&fault_scenario("runaway"), 1);
}

#[test]
fn wrong_reading_of_the_encoder_is_left_out() {
    let (flown, judgement) = passed(&fault_scenario("encoder-glitch"), 1);
    let index = flown
        .frames
        .iter()
        .position(|frame| frame.record.flags.contains(Flag::EncoderGlitch))
        .unwrap();
    assert!(judgement.errors[index].unwrap().pp_error_px.abs() < 0.1);
}

#[test]
fn limit_switch_stops_the_stage() {
    passed(&fault_scenario("limit-switch"), 1);
}

#[test]
fn late_shutter_is_recorded_where_it_opened() {
    let (flown, judgement) = passed(&fault_scenario("shutter-late"), 1);
    let late = flown
        .frames
        .iter()
        .zip(&judgement.errors)
        .filter(|(frame, _)| !frame.record.faults.is_empty());
    for (_, errors) in late {
        // At 12 mm/s 3 ms are 4 px: they are in the record.
        assert!(errors.unwrap().pp_error_px.abs() < 0.1);
    }
}

#[test]
fn shutter_that_stays_shut_leaves_a_refusal_and_no_exposure() {
    let (flown, _) = passed(&fault_scenario("shutter-missing"), 1);
    let exposed = |outcome: &Outcome| matches!(outcome, Outcome::Exposed(_));
    let count = flown
        .frames
        .iter()
        .filter(|frame| exposed(&frame.record.outcome))
        .count();
    assert_eq!(count, flown.frames.len() - 1);
}

#[test]
fn bouncing_sensor_is_noticed_and_the_frame_is_right() {
    let (flown, judgement) = passed(&fault_scenario("shutter-double"), 1);
    for (frame, errors) in flown.frames.iter().zip(&judgement.errors) {
        assert!(
            errors.unwrap().pp_error_px.abs() < 0.1,
            "{:?}",
            frame.record.sequence
        );
    }
}

#[test]
fn trigger_that_comes_too_soon_is_refused_and_disturbs_nothing() {
    let (_, judgement) = passed(&fault_scenario("trigger-overlap"), 1);
    assert_eq!(
        judgement
            .errors
            .iter()
            .filter(|errors| errors.is_none())
            .count(),
        1
    );
}

#[test]
fn records_outlast_a_cut_of_the_link() {
    let (flown, _) = passed(&fault_scenario("uart-cut"), 1);
    assert!(flown.lost_requests > 0);
    let sequences = flown.frames.iter().map(|frame| frame.record.sequence);
    assert!(sequences.eq(1..=24));
}
