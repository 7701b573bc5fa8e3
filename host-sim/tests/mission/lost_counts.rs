//! Counts that the encoder loses or adds, standing and in flight, at once and one by one: they are
//! seen, or within σ.

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome};
use fmc_simulation::mission::fault::{InjectedFault, Injection};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::{fault_scenario, flown};

/// Sums of the counts, µm.
const SIZES_UM: [f64; 12] = [
    0.01, 0.1, 0.2, 0.3, 0.5, 1.0, 2.5, 6.0, 13.0, 40.0, 300.0, 900.0,
];

/// Onsets in the flight, s from the trigger of a frame: waiting, in the run-up, in the exposure,
/// and on the way back.
const ONSETS_S: [f64; 4] = [-0.15, 0.01, 0.0225, 0.05];

fn scenario(faults: &[Injection]) -> MissionScenario {
    let mut scenario = fault_scenario("counts-lost");
    scenario.written.flight.exposures = 12;
    let mut planned = scenario.faults[0].clone();
    scenario.faults.clear();
    for fault in faults {
        planned.injection = *fault;
        scenario.faults.push(planned.clone());
    }
    scenario
}

/// Returns true if the camera has named the encoder, or a mark that is not where it was.
fn is_seen(flown: &Flown) -> bool {
    flown
        .announced
        .iter()
        .any(|(_, fault)| matches!(fault, Fault::Encoder | Fault::IndexMark))
}

/// Size from which lost counts are always seen, µm: the step of 0.1 µm, five σ of the mark, and
/// what uneven motion at the mark explains.
const SEEN_UM: f64 = 0.5;

/// Checks that every exposure is right to within 3 σ; to within 5 σ where a few counts may have
/// been lost unseen.
fn check(scenario: &MissionScenario, flown: &Flown, size_um: f64, case: &str) {
    let sigmas = if size_um.abs() < SEEN_UM { 5.0 } else { 3.0 };
    let errors = Judgement::of(scenario, flown).errors;
    let mut judged = 0;
    for (frame, errors) in flown.frames.iter().zip(&errors) {
        let Some(errors) = errors else {
            continue;
        };
        judged += 1;
        let ratio = errors.pp_error_px / errors.sigma_px;
        let flags: Vec<_> = frame.record.flags.iter().map(Flag::name).collect();
        assert!(
            ratio.abs() <= sigmas,
            "{case}: record {}: {ratio:.1} σ, {flags:?}, {:?}",
            frame.record.sequence,
            flown.announced
        );
    }
    assert!(judged > 8, "{case}: {judged} exposures");
}

#[test]
fn lost_counts_of_any_size_are_seen_or_within_three_sigma() {
    let trigger_s = fault_scenario("counts-lost").faults[0].injection.onset_s + 0.1 - 3.0 * 0.5;
    for size_um in SIZES_UM.into_iter().flat_map(|size_um| [size_um, -size_um]) {
        for onset_s in ONSETS_S.map(|after_s| trigger_s + after_s) {
            let at_once = Injection::new(InjectedFault::CountsLost, onset_s).of_size(size_um);
            for fault in [at_once, at_once.lasting(1.2)] {
                let scenario = scenario(&[fault]);
                let flown = flown(&scenario, 1);
                check(&scenario, &flown, size_um, &format!("{fault:?}"));
                assert!(is_seen(&flown) || size_um.abs() < SEEN_UM, "{fault:?}");
            }
        }
    }
}

#[test]
fn counts_that_are_lost_before_arming_are_found_by_it() {
    for size_um in SIZES_UM.into_iter().flat_map(|size_um| [size_um, -size_um]) {
        let fault = Injection::new(InjectedFault::CountsLost, 0.0).of_size(size_um);
        let scenario = scenario(&[fault]);
        let flown = flown(&scenario, 1);
        assert!(is_seen(&flown) || size_um.abs() < SEEN_UM, "{size_um}");
        let is_exposed = |frame: &&_| {
            let frame: &fmc_simulation::mission::flown::FlownFrame = frame;
            matches!(frame.record.outcome, Outcome::Exposed(_))
        };
        if flown.frames.iter().filter(is_exposed).count() > 0 {
            check(
                &scenario,
                &flown,
                size_um,
                &format!("{size_um} before arming"),
            );
        }
    }
}

#[test]
fn every_record_of_a_nominal_flight_is_referenced() {
    let scenario = MissionScenario::nominal(Some(40)).unwrap();
    let flown = flown(&scenario, 2);
    assert_eq!(flown.frames.len(), 40);
    for frame in &flown.frames {
        assert!(!frame.record.flags.contains(Flag::Unreferenced));
        assert!(frame.record.faults.is_empty());
    }
}
