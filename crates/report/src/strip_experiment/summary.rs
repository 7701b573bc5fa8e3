//! The strip experiment for programs: `summary.json`.

use fmc_adjustment::correction::COEFFICIENT_NAMES;
use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::{CONFIDENCE, Estimate};
use fmc_simulation::strip_experiment::experiment::{Experiment, Points};
use serde::Serialize;

use super::rows::most_iterations;
use super::verdict::{self, Verdict};

/// The numbers of a strip experiment. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the camera.
    pub camera: String,
    /// Seed of the noise.
    pub seed: u64,
    /// Number of repetitions.
    pub repetitions: usize,
    /// Number of frames of each flight.
    pub frames: usize,
    /// Number of images of control points in each flight.
    pub control_points: usize,
    /// Number of check points in each flight.
    pub check_points: usize,
    /// V/H, 1/s.
    pub vh_per_s: f64,
    /// δ, µm.
    pub travel_um: f64,
    /// c̄, µm.
    pub centroid_um: f64,
    /// Probability that an interval holds the true value.
    pub confidence: f64,
    /// Ratio of the residuals of pure noise after and before five coefficients are fitted.
    pub ratio_of_pure_noise: f64,
    /// Planimetric RMS that survey and image noise cause by themselves, m.
    pub noise_floor_m: f64,
    /// Results of every model.
    pub models: Vec<ModelSummary>,
    /// The same for the flight without its focus shift; `None` if it has none.
    pub models_without_focus_shift: Option<Vec<ModelSummary>>,
    /// Verdicts on every model but the static one, against the static one.
    pub verdicts: Vec<Verdict>,
    /// Further sentences.
    pub findings: Vec<String>,
    /// Headline of the report.
    pub headline: String,
}

/// The numbers of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelSummary {
    /// Key of the model.
    pub model: &'static str,
    /// Planimetric RMS at control points, mean over the repetitions, m.
    pub control_m: Estimate,
    /// Planimetric RMS at check points, m.
    pub check_m: Estimate,
    /// Ratio to the static model at control points, repetition by repetition.
    pub control_ratio: Estimate,
    /// Ratio to the static model at check points.
    pub check_ratio: Estimate,
    /// Image RMS, Yuan et al. 2012, eq. 29, µm.
    pub image_rms_um: Estimate,
    /// Number of iterations until the RMS stays within 0.1 % of its last value, in the repetition
    /// that needed most.
    pub most_iterations: usize,
    /// σ0.
    pub sigma0: Estimate,
    /// Probability that an orientation element lies within one σ of the truth.
    pub coverage: Estimate,
    /// Fitted coefficients in powers of mm; empty if none are fitted.
    pub coefficients: Vec<CoefficientSummary>,
}

/// One fitted coefficient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoefficientSummary {
    /// Symbol.
    pub name: &'static str,
    /// Mean over the repetitions.
    pub mean: Estimate,
    /// Mean of the standard deviations that the adjustments give.
    pub standard_deviation: f64,
}

impl Summary {
    /// Returns the summary of an experiment, and of the flight without focus shift beside it.
    #[must_use]
    pub fn of(experiment: &Experiment, without_shift: Option<&Experiment>) -> Self {
        let interior = experiment.strip.corrections.interior();
        let mut findings = verdict::comparisons(experiment);
        findings.push(verdict::noise_floor(experiment));
        let models = |experiment| -> Vec<ModelSummary> {
            let models = Model::ALL.into_iter();
            models
                .map(|model| ModelSummary::of(experiment, model))
                .collect()
        };
        if let Some(without) = without_shift {
            findings.extend(verdict::without_focus_shift(experiment, without));
        }
        findings.push(verdict::pure_noise(experiment));
        findings.extend(verdict::coverage(experiment));
        Self {
            scenario: experiment.scenario.written.name.clone(),
            camera: experiment.scenario.camera.name.clone(),
            seed: experiment.seed,
            repetitions: experiment.repetitions.len(),
            frames: experiment.strip.frames.len(),
            control_points: experiment.control_observations() / 2,
            check_points: experiment.check_points(),
            vh_per_s: experiment.scenario.vh_per_s(),
            travel_um: 1e3 * interior.travel_mm,
            centroid_um: 1e3 * interior.centroid_mm,
            confidence: CONFIDENCE,
            ratio_of_pure_noise: experiment.ratio_of_pure_noise(),
            noise_floor_m: experiment.scenario.noise_floor_m(),
            models: models(experiment),
            models_without_focus_shift: without_shift.map(models),
            verdicts: verdict::verdicts(experiment),
            findings,
            headline: verdict::headline(experiment),
        }
    }
}

impl ModelSummary {
    fn of(experiment: &Experiment, model: Model) -> Self {
        let coefficients = COEFFICIENT_NAMES
            .into_iter()
            .enumerate()
            .zip(model.estimated())
            .filter(|(_, is_fitted)| *is_fitted)
            .map(|((index, name), _)| {
                let of = |all: &[f64; 5]| all.get(index).copied().unwrap_or(f64::NAN);
                let sigmas = experiment.each(model, |outcome| of(&outcome.coefficient_sigmas));
                CoefficientSummary {
                    name,
                    mean: Estimate::of_mean(
                        &experiment.each(model, |outcome| of(&outcome.coefficients)),
                    ),
                    standard_deviation: Estimate::of_mean(&sigmas).value,
                }
            })
            .collect();
        Self {
            model: model.key(),
            control_m: experiment.error_m(model, Points::Control),
            check_m: experiment.error_m(model, Points::Check),
            control_ratio: experiment.ratio_to_static(model, Points::Control),
            check_ratio: experiment.ratio_to_static(model, Points::Check),
            image_rms_um: Estimate::of_mean(&experiment.each(model, |outcome| {
                1e3 * outcome.rms_mm.last().copied().unwrap_or(f64::NAN)
            })),
            most_iterations: most_iterations(experiment, model),
            sigma0: Estimate::of_mean(&experiment.each(model, |outcome| outcome.sigma0)),
            coverage: experiment.coverage(model),
            coefficients,
        }
    }
}
