//! Scenarios and their flights.

use std::path::{Path, PathBuf};

use fmc_simulation::mechanics::Mechanics;
use fmc_simulation::mission::flight_loop::{FlightOptions, fly};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;
use host_sim::device::{FlyingDevice, InProcess};

pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios")
}

/// Returns a shipped fault scenario.
pub(crate) fn fault_scenario(name: &str) -> MissionScenario {
    let path = folder().join("faults").join(format!("{name}.toml"));
    MissionScenario::read(&path, None).unwrap()
}

/// Flies a scenario in this process.
pub(crate) fn flown(scenario: &MissionScenario, seed: u64) -> Flown {
    flown_with(scenario, seed, None)
}

/// Flies a scenario in this process, with the rounds of a frame.
pub(crate) fn flown_with(scenario: &MissionScenario, seed: u64, frame: Option<u32>) -> Flown {
    let mut device = InProcess::default();
    device
        .prepare(&scenario.camera.parameters(), &scenario.flight_settings())
        .unwrap();
    let mechanics = Mechanics::seeded(scenario.written.mechanics, seed).unwrap();
    let options = FlightOptions { seed, frame };
    fly(scenario, options, mechanics, &mut device, |_| {}).unwrap()
}

/// Returns the flight and its judgement, of which every finding must pass.
pub(crate) fn passed(scenario: &MissionScenario, seed: u64) -> (Flown, Judgement) {
    let flown = flown(scenario, seed);
    let judgement = Judgement::of(scenario, &flown);
    let failed: Vec<String> = judgement
        .checks
        .iter()
        .filter(|check| !check.passed)
        .map(|check| format!("{}: {}", check.what, check.found))
        .collect();
    assert!(
        failed.is_empty(),
        "{}: {failed:#?}\nannounced {:?}\nstates {:?}",
        scenario.file,
        flown.announced.iter().take(10).collect::<Vec<_>>(),
        flown.states.iter().rev().take(10).collect::<Vec<_>>()
    );
    (flown, judgement)
}
