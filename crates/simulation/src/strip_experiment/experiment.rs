//! Experiment: many repetitions of one scenario, each with its own errors, adjusted with every
//! model.

use fmc_adjustment::adjustment::AdjustmentError;
use fmc_adjustment::exterior_orientation::ELEMENTS;
use fmc_adjustment::model::Model;
use fmc_adjustment::statistics::Estimate;
use fmc_camera_file::InputError;

use super::outcome::Outcome;
use super::scenario::Scenario;
use super::strip::Strip;
use super::survey::{Errors, observe};
use crate::noise::Noise;

/// One repetition: an outcome for each of [`Model::ALL`].
pub type Repetition = Vec<Outcome>;

/// All repetitions.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Scenario of the strip.
    pub scenario: Scenario,
    /// Seed of all noise.
    pub seed: u64,
    /// The strip without errors.
    pub strip: Strip,
    /// Repetitions, one after the other.
    pub repetitions: Vec<Repetition>,
}

/// Kind of a ground point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Points {
    /// Points that take part in the adjustment.
    Control,
    /// Points that do not take part.
    Check,
}

/// Error of an experiment.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExperimentError {
    /// The scenario cannot be recorded, or its observations do not determine the unknowns.
    #[error(transparent)]
    Scenario(#[from] InputError),
    /// The adjustment of a repetition does not converge; names scenario and model.
    #[error("{0}")]
    NotConverged(String),
}

impl Experiment {
    /// Repeats a scenario; `done` is called after every repetition.
    ///
    /// # Errors
    /// [`ExperimentError`] of [`Strip::new`], and of an adjustment that cannot separate its
    /// unknowns or does not converge.
    pub fn run(
        scenario: Scenario,
        seed: u64,
        repetitions: u32,
        mut done: impl FnMut(),
    ) -> Result<Self, ExperimentError> {
        let strip = Strip::new(&scenario, seed)?;
        let errors = Errors::of(&scenario);
        let mut all = Vec::new();
        for repetition in 1..=u64::from(repetitions) {
            // Stream 0 holds the attitudes of the strip.
            let observed = observe(&strip, &errors, Noise::new(seed, repetition));
            let outcomes = Model::ALL
                .into_iter()
                .map(|model| {
                    Outcome::of(&strip, &observed, &errors, model)
                        .map_err(|error| refused(&scenario, model, &error))
                })
                .collect::<Result<_, _>>()?;
            all.push(outcomes);
            done();
        }
        Ok(Self {
            scenario,
            seed,
            strip,
            repetitions: all,
        })
    }

    /// Returns a number of the outcome of every flight.
    pub fn each(&self, model: Model, number: impl Fn(&Outcome) -> f64) -> Vec<f64> {
        self.repetitions
            .iter()
            .filter_map(|outcomes| outcomes.get(model.index()))
            .map(number)
            .collect()
    }

    /// Returns the planimetric RMS of every flight, m.
    #[must_use]
    pub fn ground_m(&self, model: Model, points: Points) -> Vec<f64> {
        self.each(model, |outcome| match points {
            Points::Control => outcome.control_m,
            Points::Check => outcome.check_m,
        })
    }

    /// Returns the mean planimetric RMS, m.
    #[must_use]
    pub fn error_m(&self, model: Model, points: Points) -> Estimate {
        Estimate::of_mean(&self.ground_m(model, points))
    }

    /// Returns the planimetric RMS as a multiple of that of the static calibration, repetition by
    /// repetition.
    #[must_use]
    pub fn ratio_to_static(&self, model: Model, points: Points) -> Estimate {
        Estimate::of_ratio(
            &self.ground_m(model, points),
            &self.ground_m(Model::Static, points),
        )
    }

    /// Returns how often an element of the exterior orientation is within one σ of the truth. The
    /// elements of one repetition depend on each other; repetitions do not.
    #[must_use]
    pub fn coverage(&self, model: Model) -> Estimate {
        let elements = ELEMENTS * self.strip.frames.len();
        let elements = f64::from(u32::try_from(elements).unwrap_or(u32::MAX));
        Estimate::of_mean(&self.each(model, |outcome| {
            f64::from(outcome.covered.iter().sum::<u32>()) / elements
        }))
    }

    /// Number of image observations of control points, two per point.
    #[must_use]
    pub fn control_observations(&self) -> usize {
        let frames = self.strip.frames.iter();
        2 * frames.map(|frame| frame.control.len()).sum::<usize>()
    }

    /// Number of check points in all frames.
    #[must_use]
    pub fn check_points(&self) -> usize {
        self.strip
            .frames
            .iter()
            .map(|frame| frame.check.len())
            .sum()
    }

    /// Returns the factor by which `K_m0` to `P_m1` lower the residuals of pure noise at the points
    /// to which they are fitted: √(1 - 5/(2n)), with the orientations held.
    #[must_use]
    pub fn ratio_of_pure_noise(&self) -> f64 {
        let observations = u32::try_from(self.control_observations()).unwrap_or(u32::MAX);
        (1.0 - 5.0 / f64::from(observations)).max(0.0).sqrt()
    }
}

fn refused(scenario: &Scenario, model: Model, error: &AdjustmentError) -> ExperimentError {
    let pos = &scenario.written.pos;
    let free: Vec<&str> = [
        ("position_sigma_m", pos.position_sigma_m.each()),
        ("attitude_sigma_deg", pos.attitude_sigma_deg.each()),
    ]
    .into_iter()
    .filter(|(_, sigmas)| sigmas.contains(&None))
    .map(|(key, _)| key)
    .collect();
    match error {
        AdjustmentError::Inseparable(_) if !free.is_empty() => scenario
            .fault(
                &format!("pos.{} = \"free\"", free.join(", ")),
                format!("{error} (model: {})", model.label()),
            )
            .with_help("give the standard deviations of the observed position and attitude")
            .into(),
        AdjustmentError::Inseparable(_) => scenario
            .fault("pos, control.points", format!("{error} (model: {})", model.label()))
            .with_help(
                "smaller standard deviations of position and attitude, or control points spread over the frame and in height",
            )
            .into(),
        AdjustmentError::NotConverged => {
            ExperimentError::NotConverged(format!(
                "{}: {} ({error})",
                scenario.file,
                model.label()
            ))
        }
    }
}
