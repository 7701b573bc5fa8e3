//! The comparison for programs: `summary.json`.

use std::collections::BTreeMap;

use fmc_adjustment::bundle::record_tests::RECORD_ERROR;
use fmc_adjustment::statistics::Estimate;
use fmc_simulation::block_experiment::experiment::{BlockExperiment, Request};
use fmc_simulation::block_experiment::variant::Variant;
use serde::Serialize;

use super::findings;
use crate::limits::LimitCheck;

/// Share of runs in which the tests of all records name no good one.
const NAMED_NONE: f64 = 1.0 - RECORD_ERROR;

/// The numbers of the comparison. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the camera.
    pub camera: String,
    /// The request.
    pub request: Request,
    /// `true` if no limit is exceeded.
    pub passed: bool,
    /// Number of frames.
    pub frames: usize,
    /// Mean number of image points of a run.
    pub image_points: f64,
    /// Mean number of check points of a run.
    pub check_points: f64,
    /// Adjustments that are compared.
    pub variants: Vec<VariantSummary>,
    /// Conclusions from the numbers.
    pub findings: Vec<String>,
    /// Numbers that are compared with a limit.
    pub checks: Vec<LimitCheck>,
}

/// Numbers of one variant, means over the runs with their 95 % intervals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VariantSummary {
    /// Name in files.
    pub variant: &'static str,
    /// Name in reports.
    pub label: &'static str,
    /// Root mean square at check points along the strips, m.
    pub along_m: Estimate,
    /// Across the strips, m.
    pub across_m: Estimate,
    /// In height, m.
    pub height_m: Estimate,
    /// Object points less those with records along the strips, across and in height, root mean
    /// square, m.
    pub from_records_m: [Estimate; 3],
    /// σ0.
    pub sigma0: Estimate,
    /// Share of runs whose σ0 is beyond the value that a right one exceeds with 5 %.
    pub sigma0_beyond: Estimate,
    /// Frames whose records are named, with the number of runs.
    pub named: BTreeMap<String, u32>,
}

impl Summary {
    /// Returns the summary of an experiment.
    #[must_use]
    pub fn of(experiment: &BlockExperiment) -> Self {
        let runs = &experiment.runs;
        let checks = checks(experiment);
        Self {
            scenario: experiment.scenario.written.name.clone(),
            camera: experiment.scenario.camera.name.clone(),
            request: experiment.request,
            passed: checks.iter().all(|check| check.passed),
            frames: experiment.scenario.plan.stations.len(),
            image_points: mean(runs.iter().map(|run| run.image_points)),
            check_points: mean(runs.iter().map(|run| run.check_points)),
            variants: experiment
                .variants
                .iter()
                .map(|variant| of_variant(experiment, *variant))
                .collect(),
            findings: findings::of(experiment),
            checks,
        }
    }
}

fn of_variant(experiment: &BlockExperiment, variant: Variant) -> VariantSummary {
    let [along_m, across_m, height_m] = experiment.check_m(variant);
    let mut named = BTreeMap::new();
    for outcome in experiment.outcomes(variant) {
        for frame in &outcome.named {
            *named.entry(frame.clone()).or_insert(0) += 1;
        }
    }
    VariantSummary {
        variant: variant.key(),
        label: variant.label(),
        along_m,
        across_m,
        height_m,
        from_records_m: experiment.from_records_m(variant),
        sigma0: experiment.sigma0(variant),
        sigma0_beyond: experiment.beyond(variant),
        named,
    }
}

fn checks(experiment: &BlockExperiment) -> Vec<LimitCheck> {
    let written = &experiment.scenario.written;
    let mut checks = Vec::new();
    if let Some(limit_m) = written.limits.records_along_m {
        let [along_m, ..] = experiment.check_m(Variant::Records);
        checks.push(LimitCheck {
            what: "records, along the strips".to_owned(),
            found: format!("{:.2} cm", 100.0 * along_m.value),
            limit: format!("at most {:.2} cm", 100.0 * limit_m),
            passed: along_m.value <= limit_m,
        });
    }
    let good = if let Some(wrong) = &written.wrong_record {
        let share = findings::names_it(experiment, wrong);
        checks.push(LimitCheck {
            what: format!("the wrong record of frame {} is named", wrong.frame),
            found: findings::runs(experiment, share.value),
            limit: "all runs".to_owned(),
            passed: share.value >= 1.0,
        });
        findings::names_no_other(experiment, wrong)
    } else {
        experiment.share(Variant::Records, |outcome| outcome.named.is_empty())
    };
    checks.push(LimitCheck {
        what: "no good record is named".to_owned(),
        found: findings::runs(experiment, good.value),
        limit: format!("{:.1} % within the interval", 100.0 * NAMED_NONE),
        passed: good.upper >= NAMED_NONE,
    });
    checks
}

fn mean(counts: impl ExactSizeIterator<Item = usize>) -> f64 {
    let number = |count: usize| u32::try_from(count).map_or(f64::INFINITY, f64::from);
    let runs = number(counts.len().max(1));
    counts.map(number).sum::<f64>() / runs
}
