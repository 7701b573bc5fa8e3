//! Blocks with and without records: the shipped scenarios, a few runs of each.

use std::path::{Path, PathBuf};

use fmc_simulation::block_experiment::experiment::{BlockExperiment, Request};
use fmc_simulation::block_experiment::scenario::Scenario;
use fmc_simulation::block_experiment::variant::Variant;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-sim/scenarios/block")
}

fn experiment(name: &str, runs: u32) -> BlockExperiment {
    let scenario = Scenario::read(&folder().join(name)).unwrap();
    BlockExperiment::run(scenario, Request { runs, seed: 1 }, || {}).unwrap()
}

#[test]
fn all() {
    for name in [
        "ixm-50.toml",
        "ixm-50-centred.toml",
        "rc30.toml",
        "lens-0.03-percent.toml",
        "lens-1.2-percent.toml",
    ] {
        let start = std::time::Instant::now();
        let experiment = experiment(name, 4);
        println!(
            "{name} {:?} points {} check {}",
            start.elapsed(),
            experiment.runs[0].image_points,
            experiment.runs[0].check_points
        );
        for variant in Variant::ALL {
            let [x, y, z] = experiment.check_m(variant).map(|one| 100.0 * one.value);
            println!(
                "{:24} {x:.2} {y:.2} {z:.2} s0 {:.3} beyond {:.2} r {} lim {:.3} {:?}",
                variant.label(),
                experiment.sigma0(variant).value,
                experiment.beyond(variant).value,
                experiment.runs[0].outcomes[0].redundancy,
                experiment.runs[0].outcomes[0].sigma0_limit,
                experiment
                    .runs
                    .iter()
                    .map(|run| run.outcomes[3].named.clone())
                    .collect::<Vec<_>>()
            );
        }
    }
}
