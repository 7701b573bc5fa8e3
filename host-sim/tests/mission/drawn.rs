//! Random missions that once ended wrongly; `statistics` draws them by seed and number.

#![cfg(test)]
#![allow(clippy::unwrap_used, reason = "tests")]

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
