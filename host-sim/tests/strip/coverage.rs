//! Standard deviations compared with the scatter of simulated errors.

use std::sync::LazyLock;

use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::strip_experiment::experiment::Experiment;

use crate::strip::support::scenario;

const ONE_SIGMA: f64 = 0.682_689_492;
const REPETITIONS: u32 = 400;

static EXPERIMENT: LazyLock<Experiment> =
    LazyLock::new(|| Experiment::run(scenario("yuan-2012.toml"), 5, REPETITIONS, || ()).unwrap());

#[test]
fn one_standard_deviation_holds_the_truth_as_often_as_it_should() {
    let experiment = &*EXPERIMENT;
    for model in [Model::Scale, Model::FiveCoefficient, Model::Exact] {
        for element in 0..6 {
            let hits = experiment
                .repetitions
                .iter()
                .map(|outcomes| outcomes[model.index()].covered[element])
                .sum();
            // Each of the 18 intervals fails once in a thousand.
            let interval = Estimate::of_probability(hits, REPETITIONS, 0.999);
            assert!(
                interval.holds(ONE_SIGMA),
                "{model:?} {element}: {interval:?}"
            );
        }
    }
    // The static model leaves a focus shift in the image, which its σ do not include.
    assert!(experiment.coverage(Model::Static).upper < ONE_SIGMA);
}

#[test]
fn coefficients_scatter_as_their_standard_deviations_say() {
    let experiment = &*EXPERIMENT;
    for index in 0..5 {
        let values = experiment.each(Model::FiveCoefficient, |o| o.coefficients[index]);
        let sigmas = experiment.each(Model::FiveCoefficient, |o| o.coefficient_sigmas[index]);
        let mean = Estimate::of_mean(&values).value;
        let scatter: f64 = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 399.0;
        let ratio = scatter.sqrt() / Estimate::of_mean(&sigmas).value;
        // The limit is four standard errors of a standard deviation from 400 values.
        assert!((ratio - 1.0).abs() < 0.14, "{index}: {ratio}");
    }
}

#[test]
fn sigma_of_unit_weight_is_one_for_the_right_model() {
    let experiment = &*EXPERIMENT;
    for model in [Model::FiveCoefficient, Model::Exact] {
        let squares = experiment.each(model, |outcome| outcome.sigma0.powi(2));
        // 400 repetitions with a redundancy of at least 15: four standard errors, 4·√(2/15)/20,
        // are 0.073.
        assert!((Estimate::of_mean(&squares).value - 1.0).abs() < 0.08);
    }
}
