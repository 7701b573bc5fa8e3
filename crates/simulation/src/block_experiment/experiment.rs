//! Experiment: many runs of one block, each flown anew and adjusted with every variant.

use fmc_adjustment::bundle::calibration::BundleCalibration;
use fmc_adjustment::bundle::error::BundleCalibrationError;
use fmc_adjustment::bundle::interior::Interior;
use fmc_adjustment::bundle::record_tests::wrong_records;
use fmc_adjustment::bundle::tables::RowRole;
use fmc_adjustment::statistics::{CONFIDENCE, Estimate};
use fmc_camera::flight::camera::FrameError;
use rayon::prelude::*;
use serde::Serialize;

use super::flown_block::FlownBlock;
use super::outcome::Outcome;
use super::scenario::Scenario;
use super::variant::Variant;

/// Runs that are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Request {
    /// Number of runs.
    pub runs: u32,
    /// Seed.
    pub seed: u64,
}

/// One run: an outcome for each variant of the experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Outcomes, in the order of [`BlockExperiment::variants`].
    pub outcomes: Vec<Outcome>,
    /// Number of image points.
    pub image_points: usize,
    /// Number of check points.
    pub check_points: usize,
}

/// All runs. They depend on scenario and request alone, not on the number of threads.
#[derive(Debug, Clone)]
pub struct BlockExperiment {
    /// Scenario of the block.
    pub scenario: Scenario,
    /// The request.
    pub request: Request,
    /// Variants that are compared: those with control only where there is control.
    pub variants: Vec<Variant>,
    /// Runs, in order.
    pub runs: Vec<Run>,
}

/// Reason why a run has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum BlockError {
    /// The camera refuses an exposure.
    #[error("{file}, run {run}: the camera refuses an exposure: {error}")]
    Exposure {
        /// Scenario.
        file: String,
        /// Number of the run.
        run: u32,
        /// The camera's reason.
        error: FrameError,
    },
    /// An adjustment fails.
    #[error("{file}, run {run}, {}: {error}", variant.label())]
    Adjustment {
        /// Scenario.
        file: String,
        /// Number of the run.
        run: u32,
        /// Variant.
        variant: Variant,
        /// Reason.
        error: BundleCalibrationError,
    },
}

impl Run {
    fn of(
        scenario: &Scenario,
        variants: &[Variant],
        seed: u64,
        run: u32,
    ) -> Result<Self, BlockError> {
        let file = || scenario.file.clone();
        let block = FlownBlock::fly(scenario, seed, run).map_err(|error| BlockError::Exposure {
            file: file(),
            run,
            error,
        })?;
        let start = Interior::of(&scenario.camera);
        let failed = |variant, error| BlockError::Adjustment {
            file: file(),
            run,
            variant,
            error,
        };
        let adjusted = |variant: Variant| {
            let tables = variant.tables(&block, &start)?;
            BundleCalibration::new(&tables, start, &variant.options())
        };
        let records = Variant::Records;
        let with_records = adjusted(records).map_err(|error| failed(records, error))?;
        let outcome = |variant: Variant| {
            if variant != records {
                return Ok(Outcome::of(&adjusted(variant)?, &with_records, Vec::new()));
            }
            let tables = records.tables(&block, &start)?;
            let named = wrong_records(
                &with_records,
                &tables,
                &records.options(),
                block.records.direction,
            )?;
            Ok(Outcome::of(&with_records, &with_records, named))
        };
        let points = block.tables.object_points.rows.iter();
        Ok(Self {
            outcomes: variants
                .iter()
                .map(|variant| outcome(*variant).map_err(|error| failed(*variant, error)))
                .collect::<Result<_, _>>()?,
            image_points: block.tables.image_points.rows.len(),
            check_points: points.filter(|row| row.role == RowRole::Check).count(),
        })
    }
}

impl BlockExperiment {
    /// Flies and adjusts a block many times, on all cores; `done` is called after every run.
    ///
    /// # Errors
    /// [`BlockError`] of a run.
    pub fn run(
        scenario: Scenario,
        request: Request,
        done: impl Fn() + Sync,
    ) -> Result<Self, BlockError> {
        let has_control = scenario.written.control.points > 0;
        let variants: Vec<Variant> = Variant::ALL
            .into_iter()
            .filter(|variant| has_control || !variant.has_control())
            .collect();
        let runs = (1..=request.runs)
            .into_par_iter()
            .map(|number| {
                let run = Run::of(&scenario, &variants, request.seed, number)?;
                done();
                Ok(run)
            })
            .collect::<Result<_, BlockError>>()?;
        Ok(Self {
            scenario,
            request,
            variants,
            runs,
        })
    }

    /// Outcomes of a variant, run by run; none if it is not compared.
    pub fn outcomes(&self, variant: Variant) -> impl Iterator<Item = &Outcome> {
        let index = self.variants.iter().position(|one| *one == variant);
        self.runs
            .iter()
            .filter_map(move |run| run.outcomes.get(index?))
    }

    /// Returns a number of the outcome of every run.
    pub fn each(&self, variant: Variant, number: impl Fn(&Outcome) -> f64) -> Vec<f64> {
        self.outcomes(variant).map(number).collect()
    }

    /// Returns the mean of the check points' root mean square along the strips, across and in
    /// height, m.
    #[must_use]
    pub fn check_m(&self, variant: Variant) -> [Estimate; 3] {
        [0, 1, 2].map(|axis| Estimate::of_mean(&self.axis_m(variant, axis)))
    }

    /// Returns the mean distance of the object points from those with records along the strips,
    /// across and in height, root mean square, m.
    #[must_use]
    pub fn from_records_m(&self, variant: Variant) -> [Estimate; 3] {
        [0, 1, 2].map(|axis| {
            Estimate::of_mean(&self.each(variant, |outcome| {
                outcome
                    .from_records_m
                    .get(axis)
                    .copied()
                    .unwrap_or(f64::NAN)
            }))
        })
    }

    /// Returns the mean σ0.
    #[must_use]
    pub fn sigma0(&self, variant: Variant) -> Estimate {
        Estimate::of_mean(&self.each(variant, |outcome| outcome.sigma0))
    }

    /// Returns the share of runs whose σ0 is beyond its limit.
    #[must_use]
    pub fn beyond(&self, variant: Variant) -> Estimate {
        self.share(variant, Outcome::is_beyond)
    }

    /// Returns the share of runs whose outcome has a property.
    #[must_use]
    pub fn share(&self, variant: Variant, has: impl Fn(&Outcome) -> bool) -> Estimate {
        let (hits, trials) = self
            .outcomes(variant)
            .fold((0, 0), |(hits, trials), outcome| {
                (hits + u32::from(has(outcome)), trials + 1)
            });
        Estimate::of_probability(hits, trials, CONFIDENCE)
    }

    /// Returns by how much the check points of one variant are worse than those of another, run by
    /// run, m.
    #[must_use]
    pub fn difference_m(&self, one: Variant, other: Variant) -> [Estimate; 3] {
        [0, 1, 2].map(|axis| {
            let pairs = self.axis_m(one, axis).into_iter();
            let differences: Vec<f64> = pairs
                .zip(self.axis_m(other, axis))
                .map(|(one, other)| one - other)
                .collect();
            Estimate::of_mean(&differences)
        })
    }

    /// Returns the check points' root mean square of one variant as a multiple of that of another,
    /// run by run: along the strips, across and in height.
    #[must_use]
    pub fn ratio(&self, one: Variant, other: Variant) -> [Estimate; 3] {
        [0, 1, 2].map(|axis| Estimate::of_ratio(&self.axis_m(one, axis), &self.axis_m(other, axis)))
    }

    /// Returns the same of the place, all three axes together.
    #[must_use]
    pub fn ratio_of_places(&self, one: Variant, other: Variant) -> Estimate {
        let place_m = |variant| {
            self.each(variant, |outcome| {
                let squares = outcome.check_m.iter().map(|axis| axis * axis);
                squares.sum::<f64>().sqrt()
            })
        };
        Estimate::of_ratio(&place_m(one), &place_m(other))
    }

    fn axis_m(&self, variant: Variant, axis: usize) -> Vec<f64> {
        self.each(variant, |outcome| {
            outcome.check_m.get(axis).copied().unwrap_or(f64::NAN)
        })
    }
}
