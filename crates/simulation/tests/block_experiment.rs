//! Blocks with and without records: what each of the shipped scenarios is shipped to show.

use std::path::{Path, PathBuf};

use fmc_simulation::block_experiment::experiment::{BlockExperiment, Request};
use fmc_simulation::block_experiment::scenario::Scenario;
use fmc_simulation::block_experiment::variant::Variant;

/// The runs of which `docs/calibration-by-images.md` has the numbers.
const REQUEST: Request = Request { runs: 20, seed: 1 };

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-sim/scenarios/block")
}

fn experiment(name: &str) -> BlockExperiment {
    let scenario = Scenario::read(&folder().join(name)).unwrap();
    BlockExperiment::run(scenario, REQUEST, || {}).unwrap()
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
        let experiment = experiment(name);
        println!(
            "{name} {:?} points {} check {}",
            start.elapsed(),
            experiment.runs[0].image_points,
            experiment.runs[0].check_points
        );
        for variant in Variant::ALL {
            println!(
                "{:24} {:?} s0 {:?} beyond {:?} r {} lim {:.3}",
                variant.label(),
                experiment.check_m(variant).map(|one| (one.value * 100.0, (one.upper - one.value) * 100.0)),
                experiment.sigma0(variant),
                experiment.beyond(variant).value,
                experiment.runs[0].outcomes[0].redundancy,
                experiment.runs[0].outcomes[0].sigma0_limit,
            );
        }
        println!("{:?}", experiment.runs.iter().map(|run| run.outcomes[3].named.clone()).collect::<Vec<_>>());
        println!("gain {:?}", experiment.difference_m(Variant::Static, Variant::Records));
        println!("ratio {:?}", experiment.ratio(Variant::NotRecentred, Variant::Records));
    }
}
