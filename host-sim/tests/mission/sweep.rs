//! Onset and size of a fault can be swept, and no place in the cycle leads to a silent wrong coordinate.

use host_sim::formats::mission_scenario::{MissionScenario, PlannedFault};
use host_sim::mission::expectation::Expectation;
use host_sim::mission::fault::{InjectedFault, Injection};

use crate::support::passed;

/// A short mission with a fault in its third frame.
fn with(injection: Injection) -> MissionScenario {
    let mut scenario = MissionScenario::nominal(Some(5)).unwrap();
    scenario.interval_s = 0.4;
    scenario.faults = vec![PlannedFault {
        injection,
        expectation: Expectation::default(),
    }];
    scenario
}

#[test]
fn encoder_glitch_anywhere_in_the_cycle_moves_no_coordinate_silently() {
    for onset_ms in (0..60).step_by(3) {
        for size in [-300.0, 30.0, 2000.0] {
            let onset_s = 2.8 + f64::from(onset_ms) * 1e-3;
            let glitch = Injection::new(InjectedFault::EncoderGlitch, onset_s)
                .of_size(size)
                .lasting(0.001);
            passed(&with(glitch), 3);
        }
    }
}

#[test]
fn jam_anywhere_in_the_cycle_moves_no_coordinate_silently() {
    for onset_ms in (0..60).step_by(4) {
        let onset_s = 2.8 + f64::from(onset_ms) * 1e-3;
        let jam = Injection::new(InjectedFault::Stall, onset_s).lasting(0.05);
        passed(&with(jam), 3);
    }
}
