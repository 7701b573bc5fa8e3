//! Data sets that cannot separate unknowns: the error names them.

use fmc_adjustment::adjustment::AdjustmentError;
use fmc_adjustment::model::Model;
use fmc_simulation::strip_experiment::scenario::Scenario;
use fmc_simulation::strip_experiment::scenario_file::{Free, Sigma};
use fmc_simulation::strip_experiment::strip::Strip;

use crate::strip::support::{SHIPPED, scenario, solved};

fn unseparated(scenario: &Scenario, model: Model) -> Vec<String> {
    let strip = Strip::new(scenario, 1).unwrap();
    match solved(scenario, &strip, model, 1.0) {
        Err(AdjustmentError::Inseparable(error)) => error.unknowns,
        other => panic!("{other:?}"),
    }
}

/// Returns a scenario of flat ground: control points at the height of the terrain.
fn flat(name: &str) -> Scenario {
    let mut scenario = scenario(name);
    let height_m = scenario.written.terrain.height_m;
    scenario.written.terrain.relief_m = 0.0;
    for point in &mut scenario.written.control.points {
        point.z_m = height_m;
    }
    scenario
}

fn free(mut scenario: Scenario) -> Scenario {
    scenario.written.pos.position_sigma_m = Sigma::Word(Free::Free);
    scenario.written.pos.attitude_sigma_deg = Sigma::Word(Free::Free);
    scenario
}

#[test]
fn scale_and_height_of_a_free_frame_over_flat_ground_are_one() {
    for name in SHIPPED {
        let unknowns = unseparated(&free(flat(name)), Model::Scale);
        assert_eq!(unknowns, ["K_m0", "Z_S"], "{name}");
    }
}

#[test]
fn five_coefficients_of_a_free_frame_name_a_pair_on_flat_ground_and_over_relief() {
    for name in SHIPPED {
        for scenario in [free(flat(name)), free(scenario(name))] {
            let unknowns = unseparated(&scenario, Model::FiveCoefficient);
            let names = |all: &[&str]| all.iter().all(|one| unknowns.iter().any(|own| own == one));
            let scale = names(&["K_m0", "Z_S"]);
            let tilt = names(&["K_d1", "pitch", "Y_S"]);
            assert!(scale || tilt, "{name}: {unknowns:?}");
        }
    }
}

#[test]
fn tilt_is_named_where_the_height_is_observed() {
    let mut scenario = flat("yuan-2012.toml");
    scenario.written.flight.attitude_spread_deg = [0.0; 3];
    scenario.written.pos.attitude_sigma_deg = Sigma::Word(Free::Free);
    scenario.written.pos.position_sigma_m = Sigma::Each([1000.0, 1000.0, 0.05]);
    let strip = Strip::new(&scenario, 1).unwrap();
    match solved(&scenario, &strip, Model::FiveCoefficient, 0.0) {
        Err(AdjustmentError::Inseparable(error)) => {
            assert_eq!(error.unknowns, ["K_d1", "Y_S", "pitch"]);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn observed_orientations_make_both_scenarios_regular_on_flat_ground() {
    for name in SHIPPED {
        let scenario = flat(name);
        let strip = Strip::new(&scenario, 1).unwrap();
        solved(&scenario, &strip, Model::FiveCoefficient, 1.0).unwrap();
    }
}

#[test]
fn free_orientations_alone_are_no_obstacle_without_coefficients() {
    for name in SHIPPED {
        let scenario = free(scenario(name));
        let strip = Strip::new(&scenario, 1).unwrap();
        solved(&scenario, &strip, Model::Exact, 1.0).unwrap();
    }
}
