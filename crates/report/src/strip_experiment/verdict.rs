//! Conclusions from the intervals, in words.

use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::strip_experiment::experiment::{Experiment, Points};
use serde::Serialize;

use super::rows::{decimals_of, interval};

/// Conclusion from the interval of a ratio of errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// The whole interval is below 1: the error is smaller.
    Gain,
    /// The whole interval is above 1: the error is larger.
    Loss,
    /// The interval holds 1.
    Undecided,
}

impl Change {
    /// Returns the conclusion from a ratio of errors.
    #[must_use]
    pub fn of(ratio: &Estimate) -> Self {
        if ratio.upper < 1.0 {
            Self::Gain
        } else if ratio.lower > 1.0 {
            Self::Loss
        } else {
            Self::Undecided
        }
    }
}

/// A model against the static calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Key of the model.
    pub model: &'static str,
    /// Change at the points of the adjustment.
    pub control: Change,
    /// Change at new points.
    pub check: Change,
    /// Both changes in a sentence.
    pub sentence: String,
}

/// Compares every model but the static one with the static one.
#[must_use]
pub fn verdicts(experiment: &Experiment) -> Vec<Verdict> {
    Model::ALL
        .into_iter()
        .filter(|model| *model != Model::Static)
        .map(|model| {
            let control = experiment.ratio_to_static(model, Points::Control);
            let check = experiment.ratio_to_static(model, Points::Check);
            Verdict {
                model: model.key(),
                control: Change::of(&control),
                check: Change::of(&check),
                sentence: sentence(model.label(), &control, &check),
            }
        })
        .collect()
}

fn sentence(label: &str, control: &Estimate, check: &Estimate) -> String {
    let fate = match (Change::of(control), Change::of(check)) {
        // If the intervals do not overlap, the gain at check points is smaller.
        (Change::Gain, Change::Gain) if control.upper < check.lower => {
            "the gain survives on check points, but smaller".to_owned()
        }
        (Change::Gain, Change::Gain) => "the gain survives on check points".to_owned(),
        (Change::Gain, Change::Loss) => {
            "the gain does not survive: check points are worse".to_owned()
        }
        (Change::Gain, Change::Undecided) => {
            "the gain does not survive: no change at check points is shown".to_owned()
        }
        (Change::Loss, Change::Loss) => "worse at control and check points".to_owned(),
        (_, Change::Gain) => "better at check points".to_owned(),
        (_, Change::Loss) => "worse at check points".to_owned(),
        (_, Change::Undecided) => "no change at check points is shown".to_owned(),
    };
    format!(
        "{label}: {fate} (control {}, check {}).",
        percent(control),
        percent(check)
    )
}

/// Compares five coefficients with the scale alone, and the exact model with five coefficients and
/// with the focus shift alone.
#[must_use]
pub fn comparisons(experiment: &Experiment) -> Vec<String> {
    let ratio = |model, to, points| {
        Estimate::of_ratio(
            &experiment.ground_m(model, points),
            &experiment.ground_m(to, points),
        )
    };
    [
        (
            "Fitting the other four coefficients beside K_m0",
            Model::FiveCoefficient,
            Model::Scale,
        ),
        (
            "The exact model instead of the five fitted coefficients",
            Model::Exact,
            Model::FiveCoefficient,
        ),
        (
            "Knowing the motion of the principal point beside the focus shift, which is the exact model's part,",
            Model::Exact,
            Model::Focus,
        ),
    ]
    .into_iter()
    .map(|(what, model, to)| {
        let check = ratio(model, to, Points::Check);
        let says = match Change::of(&check) {
            Change::Gain => "lowers the error at check points",
            Change::Loss => "raises the error at check points",
            Change::Undecided => "does not change the error at check points as far as is shown",
        };
        format!(
            "{what} {says}: {} (at control points {}).",
            percent(&check),
            percent(&ratio(model, to, Points::Control))
        )
    })
    .collect()
}

/// Describes the part of the ground errors that survey and image noise cause, and the gain of the
/// exact model beyond it.
#[must_use]
pub fn noise_floor(experiment: &Experiment) -> String {
    let floor_m = experiment.scenario.noise_floor_m();
    let beyond = |model| {
        let error_m = experiment.error_m(model, Points::Check).value;
        (error_m.powi(2) - floor_m.powi(2)).max(0.0).sqrt()
    };
    let [fixed_m, exact_m] = [Model::Static, Model::Exact].map(beyond);
    let whole = experiment.ratio_to_static(Model::Exact, Points::Check);
    let floor = format!(
        "Noise floor: the errors of surveyed points and image coordinates alone make {floor_m:.3} m at check points, which no correction lowers"
    );
    if fixed_m <= 0.0 {
        return format!("{floor}; the static model is at it.");
    }
    let decimals = decimals_of(fixed_m.min(exact_m));
    format!(
        "{floor}. What the static model leaves beyond it, in quadrature, is {fixed_m:.decimals$} m, and {exact_m:.decimals$} m with the exact model: {} %, where the whole error shows {} %.",
        change(exact_m / fixed_m),
        change(whole.value)
    )
}

/// Compares the gains with those of the same flight without focus shift.
#[must_use]
pub fn without_focus_shift(experiment: &Experiment, without: &Experiment) -> Vec<String> {
    let fixed = |experiment: &Experiment| experiment.error_m(Model::Static, Points::Check).value;
    let (with_m, without_m) = (fixed(experiment), fixed(without));
    let decimals = decimals_of(with_m.min(without_m));
    let mut sentences = vec![format!(
        "The same flight without its focus shift of {} µm: the static model leaves {without_m:.decimals$} m at check points in place of {with_m:.decimals$} m.",
        experiment.scenario.written.truth.focus_shift_um
    )];
    let gains = [Model::Scale, Model::FiveCoefficient, Model::Exact].map(|model| {
        let of =
            |experiment: &Experiment| percent(&experiment.ratio_to_static(model, Points::Check));
        format!(
            "{}: {} with the focus shift, {} without it.",
            model.label(),
            of(experiment),
            of(without)
        )
    });
    sentences.extend(gains);
    sentences
}

/// Writes the headline of the report.
#[must_use]
pub fn headline(experiment: &Experiment) -> String {
    let error = |model, points| experiment.error_m(model, points).value;
    let of = |points| {
        let [from, to] = [Model::Static, Model::FiveCoefficient].map(|model| error(model, points));
        let decimals = decimals_of(from.min(to));
        format!("{from:.decimals$} m to {to:.decimals$} m")
    };
    let control = experiment.ratio_to_static(Model::FiveCoefficient, Points::Control);
    let check = experiment.ratio_to_static(Model::FiveCoefficient, Points::Check);
    let survives = match (Change::of(&control), Change::of(&check)) {
        (Change::Gain, Change::Gain) if control.upper < check.lower => {
            "a gain at both, smaller at the check points"
        }
        (Change::Gain, Change::Gain) => "a gain at both",
        (Change::Gain, _) => "a gain at the fitted points only",
        (_, Change::Gain) => "a gain at the check points only",
        _ => "a gain at neither",
    };
    format!(
        "From the static model to five fitted coefficients the ground error goes from {} at control points and from {} at check points: {survives}.",
        of(Points::Control),
        of(Points::Check)
    )
}

/// Describes the effect of the fit alone on residuals.
#[must_use]
pub fn pure_noise(experiment: &Experiment) -> String {
    let observations = experiment.control_observations();
    format!(
        "For comparison: five coefficients fitted to pure noise in {observations} image coordinates lower the residuals at the fitted points to {:.2} of what they were, at new points not at all.",
        experiment.ratio_of_pure_noise()
    )
}

/// Describes how often the truth lies within one σ.
#[must_use]
pub fn coverage(experiment: &Experiment) -> Vec<String> {
    [Model::Static, Model::FiveCoefficient, Model::Exact]
        .into_iter()
        .map(|model| {
            let coverage = experiment.coverage(model);
            let says = if coverage.holds(ONE_SIGMA) {
                "as it should be"
            } else if coverage.value < ONE_SIGMA {
                "too seldom: the standard deviations are too good to be true"
            } else {
                "more often than promised"
            };
            format!(
                "{}: {} of the orientation elements lie within one standard deviation of the truth, {says}.",
                model.label(),
                interval(&coverage, 3)
            )
        })
        .collect()
}

/// Probability of one standard deviation.
pub(super) const ONE_SIGMA: f64 = 0.682_689_492;

/// Writes a ratio as a change, `-39.2 % (-41.2 to -37.1 %)`, or `18.34 (18.12 to 18.57) times`.
fn percent(ratio: &Estimate) -> String {
    if ratio.value > 2.0 {
        return format!("{} times", interval(ratio, 2));
    }
    format!(
        "{} % ({} to {} %)",
        change(ratio.value),
        change(ratio.lower),
        change(ratio.upper)
    )
}

/// Writes a ratio as a change in per cent, `-39.2`.
fn change(ratio: f64) -> String {
    // Adding zero turns -0 into 0.
    let percent = (1000.0 * (ratio - 1.0)).round() / 10.0 + 0.0;
    format!("{percent:+.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ratio(value: f64, half: f64) -> Estimate {
        Estimate {
            value,
            lower: value - half,
            upper: value + half,
        }
    }

    #[test]
    fn words_follow_from_the_intervals() {
        let says = |control: Estimate, check: Estimate| sentence("m", &control, &check);
        let gain = ratio(0.6, 0.05);
        assert!(says(gain, ratio(0.62, 0.05)).contains("survives on check points ("));
        assert!(says(gain, ratio(0.9, 0.05)).contains("survives on check points, but smaller"));
        assert!(says(gain, ratio(0.98, 0.05)).contains("does not survive: no change"));
        assert!(says(gain, ratio(1.1, 0.05)).contains("does not survive: check points are worse"));
        assert!(says(ratio(1.0, 0.1), gain).contains("better at check points"));
        assert!(says(ratio(1.2, 0.1), ratio(1.2, 0.1)).contains("worse at control and check"));
    }

    #[test]
    fn intervals_that_hold_one_decide_nothing() {
        assert_eq!(Change::of(&ratio(0.99, 0.02)), Change::Undecided);
        assert_eq!(Change::of(&ratio(0.97, 0.02)), Change::Gain);
        assert_eq!(Change::of(&ratio(1.03, 0.02)), Change::Loss);
        assert_eq!(percent(&ratio(0.608, 0.02)), "-39.2 % (-41.2 to -37.2 %)");
    }
}
