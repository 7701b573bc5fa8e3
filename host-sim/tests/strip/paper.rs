//! Numbers of Yuan et al. 2012, section 4.2, and their counterparts at check points.

use fmc_adjustment::model::Model;
use fmc_simulation::strip_experiment::experiment::{Experiment, Points};

use crate::strip::support::scenario;

#[test]
fn papers_scenario_is_of_the_papers_order_and_its_gain_shrinks_at_check_points() {
    let experiment = Experiment::run(scenario("yuan-2012.toml"), 1, 100, || ()).unwrap();
    let error = |model, points| experiment.error_m(model, points).value;
    // Printed: 0.29 m and 0.18 m.
    assert!((error(Model::Static, Points::Control) - 0.29).abs() < 0.02);
    assert!((error(Model::FiveCoefficient, Points::Control) - 0.18).abs() < 0.02);
    let control = experiment.ratio_to_static(Model::FiveCoefficient, Points::Control);
    let check = experiment.ratio_to_static(Model::FiveCoefficient, Points::Check);
    assert!(control.upper < check.lower);
    // Errata, Y12: the ratio for pure noise.
    assert!((experiment.ratio_of_pure_noise() - 0.87).abs() < 0.005);
}

#[test]
fn five_coefficients_fitted_to_pure_noise_do_not_help_at_new_points() {
    let mut quiet = scenario("yuan-2012.toml");
    quiet.written.truth.focus_shift_um = 0.0;
    let experiment = Experiment::run(quiet, 1, 100, || ()).unwrap();
    let control = experiment.ratio_to_static(Model::FiveCoefficient, Points::Control);
    let check = experiment.ratio_to_static(Model::FiveCoefficient, Points::Check);
    // With orientations adjusted, too, the ratio at the fitted points is near the 0.87 of fixed
    // orientations.
    assert!(
        (control.value - experiment.ratio_of_pure_noise()).abs() < 0.04,
        "{control:?}"
    );
    assert!(check.lower > 1.0, "{check:?}");
}

#[test]
fn static_model_needs_the_focus_shift_to_be_as_bad_as_printed() {
    let mut quiet = scenario("yuan-2012.toml");
    quiet.written.truth.focus_shift_um = 0.0;
    quiet.written.correction.focus_shift_um = Some(0.0);
    let experiment = Experiment::run(quiet, 1, 100, || ()).unwrap();
    // With a 0.03 % lens and an offset of 56 µm, the motion alone has no visible effect.
    let exact = experiment.ratio_to_static(Model::Exact, Points::Check);
    assert!((exact.value - 1.0).abs() < 1e-3, "{exact:?}");
}
