//! Table rows of the comparison of the models.

use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::strip_experiment::experiment::{Experiment, Points};

/// Row of one model.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) label: &'static str,
    pub(super) control_m: Number,
    pub(super) check_m: Number,
    pub(super) control_ratio: Number,
    pub(super) check_ratio: Number,
    pub(super) image_um: String,
    pub(super) iterations: String,
    pub(super) sigma0: String,
}

/// An estimate with its 95 % interval.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Number {
    /// With half of the interval, `0.248 ± 0.005`.
    pub(super) short: String,
    /// With both ends, `0.248 (0.243 to 0.252)`.
    pub(super) whole: String,
}

impl Number {
    fn of(estimate: &Estimate, decimals: usize) -> Self {
        let half = (estimate.upper - estimate.lower) / 2.0;
        Self {
            short: format!("{:.decimals$} ± {half:.decimals$}", estimate.value),
            whole: interval(estimate, decimals),
        }
    }

    /// Returns the ratio of an error to itself.
    fn one() -> Self {
        let [short, whole] = ["1"; 2].map(str::to_owned);
        Self { short, whole }
    }
}

pub(super) fn rows(experiment: &Experiment) -> Vec<Row> {
    Model::ALL
        .into_iter()
        .map(|model| {
            let ratio = |points| match model {
                Model::Static => Number::one(),
                _ => Number::of(&experiment.ratio_to_static(model, points), 3),
            };
            let image_um = Estimate::of_mean(&experiment.each(model, |outcome| {
                1e3 * outcome.rms_mm.last().copied().unwrap_or(f64::NAN)
            }));
            let sigma0 = Estimate::of_mean(&experiment.each(model, |outcome| outcome.sigma0));
            Row {
                label: model.label(),
                control_m: metres(&experiment.error_m(model, Points::Control)),
                check_m: metres(&experiment.error_m(model, Points::Check)),
                control_ratio: ratio(Points::Control),
                check_ratio: ratio(Points::Check),
                image_um: format!("{:.2}", image_um.value),
                iterations: most_iterations(experiment, model).to_string(),
                sigma0: format!("{:.2}", sigma0.value),
            }
        })
        .collect()
}

/// Returns the number of iterations of the repetition that needed most.
pub(super) fn most_iterations(experiment: &Experiment, model: Model) -> usize {
    experiment
        .repetitions
        .iter()
        .filter_map(|outcomes| outcomes.get(model.index()))
        .map(|outcome| outcome.iterations)
        .max()
        .unwrap_or(0)
}

/// Returns the decimals of an error in metres: tenths of a millimetre below a decimetre.
pub(super) const fn decimals_of(metres: f64) -> usize {
    if metres < 0.1 { 4 } else { 3 }
}

fn metres(estimate: &Estimate) -> Number {
    Number::of(estimate, decimals_of(estimate.value))
}

/// Writes value and interval, `0.248 (0.243 to 0.252)`.
pub(super) fn interval(estimate: &Estimate, decimals: usize) -> String {
    format!(
        "{:.decimals$} ({:.decimals$} to {:.decimals$})",
        estimate.value, estimate.lower, estimate.upper
    )
}
