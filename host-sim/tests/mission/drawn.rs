//! Random missions that once ended wrongly; `statistics` draws them by seed and number.

#![cfg(test)]
#![allow(clippy::unwrap_used, reason = "tests")]

use fmc_camera::flight::frame_record::Outcome;
use fmc_simulation::statistics::draw::{DrawOptions, DrawnMission};
use fmc_simulation::statistics::mission::FlownMission;

use crate::mission::support::flown;

/// Draws and flies a mission.
fn fly(seed: u64, faults: u32, number: u32) -> FlownMission {
    let mission = DrawnMission::draw(DrawOptions { seed, faults }, number).unwrap();
    let flown = flown(&mission.scenario, mission.scenario.seed());
    FlownMission::of(&mission, &flown)
}

/// A glitch of 16 µm in a run-up that ends before the mark is no motion of a stage with 10.8 µm of
/// play and the encoder on it.
#[test]
fn counts_lost_for_a_while_within_the_play_are_not_silent() {
    let glitch = fly(22, 2, 513);
    assert!(glitch.setup.play_um > 10.0, "{:?}", glitch.setup);
    assert_eq!(glitch.silent, [] as [u32; 0]);
}

/// A glitch of 2.8 µm that begins while the stage stands and ends after the exposure is no screw
/// that comes to a stage with 15.2 µm of play: nothing has driven it for a while.
#[test]
fn counts_lost_at_rest_within_the_play_are_not_silent() {
    let glitch = fly(62, 2, 975);
    assert!(glitch.setup.play_um > 10.0, "{:?}", glitch.setup);
    assert_eq!(glitch.silent, [] as [u32; 0]);
}

/// A glitch of 2 µm from the run-up to the end of the exposure, which the friction of the stage,
/// 1.06 µm a round, may make as well.
#[test]
fn counts_lost_for_a_while_that_friction_may_explain_are_not_silent() {
    let glitch = fly(911, 1, 1961);
    assert!(glitch.verdicts.len() > 10, "{}", glitch.verdicts.len());
    assert_eq!(glitch.silent, [] as [u32; 0]);
}

/// Set points that begin to move by 1.48 µm in a round, more than the jump tolerance of 1 µm: no
/// counts are in doubt, and σ is that of the readings, 0.02 µm.
#[test]
fn planned_acceleration_is_no_doubt_of_the_reading() {
    let mission = DrawnMission::draw(DrawOptions { seed: 5, faults: 0 }, 113).unwrap();
    let flown = flown(&mission.scenario, mission.scenario.seed());
    let sigmas_mm: Vec<f32> = flown
        .frames
        .iter()
        .filter_map(|frame| match &frame.record.outcome {
            Outcome::Exposed(exposed) => Some(exposed.principal_point_sigma.frame_mm),
            Outcome::Refused(_) => None,
        })
        .collect();
    assert!(sigmas_mm.len() > 10, "{}", sigmas_mm.len());
    assert!(sigmas_mm.iter().all(|sigma| *sigma < 1e-4), "{sigmas_mm:?}");
}

/// A sensor that misses the opening edge and shows a bounce of it 0.13 ms later: the exposure looks
/// late and short, by less than the shutter's tolerance.
#[test]
fn bounce_of_an_opening_edge_that_was_missed_is_not_silent() {
    let bounce = fly(301, 2, 330);
    assert!(bounce.verdicts.len() > 10, "{}", bounce.verdicts.len());
    assert_eq!(bounce.silent, [] as [u32; 0]);
}

/// Stages with the encoder on them and more than 9 µm of play: the screw takes the play up before
/// the trigger, and the stage is at speed when the shutter is to open. Without that way all
/// triggers of these missions were refused.
#[test]
fn play_taken_up_before_the_run_up_costs_few_frames() {
    for (seed, number, most_refused) in [(2, 140, 3), (7, 119, 0), (7, 135, 0), (31, 119, 2)] {
        let flown = fly(seed, 0, number);
        let case = format!("seed {seed}, mission {number}: {:?}", flown.setup);
        assert!(flown.setup.play_um > 9.0, "{case}");
        assert!(flown.triggers >= 10, "{case}: {}", flown.triggers);
        assert!(flown.refused <= most_refused, "{case}: {}", flown.refused);
        assert!(flown.spurious.is_empty(), "{case}: {:?}", flown.spurious);
    }
}

/// A healthy stage with an encoder of 1.7 µm on its screw, 12.8 µm off its set point at the end of
/// a fly-back over 40 µm, which was a runaway.
#[test]
fn coarse_encoder_on_a_healthy_stage_is_no_runaway() {
    let coarse = fly(912, 2, 730);
    assert!(coarse.setup.encoder_step_um > 1.6, "{:?}", coarse.setup);
    assert_eq!(coarse.spurious, [] as [&str; 0]);
    assert!(coarse.verdicts.len() > 10, "{}", coarse.verdicts.len());
}

/// Stages whose encoder on them shows contact with the screw near the index mark: their crossings
/// agree within the changes of speed, although an even acceleration does not explain them.
#[test]
fn contact_near_the_mark_is_no_fault_of_the_encoder() {
    for number in [121, 167] {
        let uneven = fly(5, 0, number);
        assert!(uneven.verdicts.len() > 10, "{}", uneven.verdicts.len());
        assert_eq!(uneven.spurious, [] as [&str; 0], "mission {number}");
    }
}
