//! Judgements of flights in which something is wrong, or in which there is nothing to judge.

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome};
use fmc_simulation::mission::expectation::Expectation;
use fmc_simulation::mission::fault::{InjectedFault, Injection};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::planned_fault::PlannedFault;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::{fault_scenario, folder, passed};

fn nominal() -> (MissionScenario, Flown) {
    let scenario = MissionScenario::nominal(Some(12)).unwrap();
    let (flown, _) = passed(&scenario, 1);
    (scenario, flown)
}

/// Returns the checks that have failed.
fn failed(scenario: &MissionScenario, flown: &Flown) -> Vec<String> {
    let checks = Judgement::of(scenario, flown).checks;
    let failed = checks.into_iter().filter(|check| !check.passed);
    failed.map(|check| check.what).collect()
}

#[test]
fn fault_that_nobody_injected_fails_a_nominal_flight() {
    const CHECK: &str = "no fault but those injected";
    let (scenario, flown) = nominal();
    let mut announced = flown.clone();
    announced.announced.push((3_000_000, Fault::VhLost));
    assert_eq!(failed(&scenario, &announced), [CHECK]);
    let mut recorded = flown.clone();
    let frame = &mut recorded.frames[5];
    frame.record.faults.insert(Fault::VhLost);
    frame.fetched_faults.insert(Fault::VhLost);
    assert!(failed(&scenario, &recorded).contains(&CHECK.to_owned()));
    // A fault that comes after an injected one may follow from it, and one before cannot.
    let mut injected = scenario.clone();
    injected.faults.push(PlannedFault {
        injection: Injection::new(InjectedFault::VhJump, 2.5),
        expectation: Expectation::default(),
    });
    announced.felt_us = vec![None];
    assert!(!failed(&injected, &announced).contains(&CHECK.to_owned()));
    announced.announced.push((2_400_000, Fault::VhLost));
    assert!(failed(&injected, &announced).contains(&CHECK.to_owned()));
}

#[test]
fn frame_that_ended_before_a_fault_does_not_show_its_flag() {
    let (mut scenario, mut flown) = nominal();
    let ended_s = |flown: &Flown, index: usize| match &flown.frames[index].record.outcome {
        Outcome::Exposed(exposed) => {
            1e-6 * u32::try_from(exposed.closed.us()).map_or(0.0, f64::from)
        }
        Outcome::Refused(_) => panic!(),
    };
    let before_s = ended_s(&flown, 5);
    flown.frames[5].record.flags.insert(Flag::EncoderGlitch);
    flown.felt_us = vec![None];
    let is_met = |scenario: &mut MissionScenario, onset_s: f64| {
        scenario.faults = vec![PlannedFault {
            injection: Injection::new(InjectedFault::EncoderGlitch, onset_s),
            expectation: Expectation {
                flag: Some(Flag::EncoderGlitch),
                ..Expectation::default()
            },
        }];
        let failed = failed(scenario, &flown);
        !failed.iter().any(|what| what.contains("flag"))
    };
    assert!(is_met(&mut scenario, before_s - 0.001));
    assert!(!is_met(&mut scenario, before_s + 0.001));
}

#[test]
fn judgement_of_nothing_passes_no_check() {
    let (nominal, mut flown) = nominal();
    flown.frames.clear();
    flown.triggers_us.clear();
    flown.announced.clear();
    flown.states.clear();
    let files = std::fs::read_dir(folder().join("faults")).unwrap();
    let names = files.map(|file| file.unwrap().path());
    let scenarios = names
        .map(|path| fault_scenario(path.file_stem().unwrap().to_str().unwrap()))
        .chain([nominal]);
    let mut judged = 0;
    for scenario in scenarios {
        flown.felt_us = vec![None; scenario.faults.len()];
        let checks = Judgement::of(&scenario, &flown).checks;
        assert!(checks.len() > 3);
        for check in checks {
            assert!(!check.passed, "{}: {}", scenario.file, check.what);
            judged += 1;
        }
    }
    assert!(judged > 100, "{judged}");
}
