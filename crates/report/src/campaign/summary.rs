//! The campaign for programs: `summary.json`.

use fmc_simulation::campaign::plan::Request;
use fmc_simulation::campaign::results::{Results, Row};
use serde::Serialize;

use crate::limits::LimitCheck;
use crate::wording;

/// Smallest share of its runs in which a fault has to arrive.
const LEAST_ARRIVED: f64 = 0.95;

/// The numbers of a campaign. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The request.
    pub request: Request,
    /// `true` if no limit is exceeded.
    pub passed: bool,
    /// Number of runs with one fault.
    pub runs: u32,
    /// Number of runs with two faults.
    pub pairs: u32,
    /// Number of exposures that are wrong by more than their record allows, without fault or flag,
    /// or of which no record tells.
    pub silent_bad_exposures: u32,
    /// Number of triggers without their record.
    pub unanswered_triggers: u32,
    /// Smallest share of the runs of any one fault in which the camera was told something else than
    /// without it.
    pub faults_arrived_share: f64,
    /// Number of runs without a fault, refusal, flag, withheld quantity or grown σ that the flight
    /// without the fault does not have. They are in the other numbers, too.
    pub runs_without_effect: u32,
    /// CRC-64 of all outcomes: the same for every number of threads.
    pub digest: String,
    /// Limits.
    pub checks: Vec<LimitCheck>,
    /// Results of every fault.
    pub rows: Vec<Row>,
    /// Findings, with the scenarios that repeat them.
    pub findings: Vec<WrongRunSummary>,
}

/// A run in which something is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WrongRunSummary {
    /// The fault or the faults, with size and duration.
    pub what: String,
    /// Number of exposures that are wrong and say nothing of it.
    pub silent_bad_exposures: u32,
    /// Number of the first of their frames, if it has a record.
    pub frame: Option<u32>,
    /// Number of triggers without their record.
    pub unanswered_triggers: u32,
    /// First effect of the fault.
    pub effect: String,
    /// Largest part of what a record without fault or flag allows that an error takes.
    pub worst: Option<f64>,
    /// Quantity of this error; empty without one.
    pub quantity: String,
    /// Scenario that repeats it.
    pub scenario: String,
}

impl Summary {
    /// Returns the summary of results.
    #[must_use]
    pub fn of(request: Request, results: &Results) -> Self {
        let findings = results.findings.iter().zip(1..);
        let mut summary = Self {
            request,
            passed: false,
            runs: results.runs,
            pairs: results.pairs,
            silent_bad_exposures: results.sum(|row| row.silent_bad_exposures),
            unanswered_triggers: results.sum(|row| row.unanswered_triggers),
            faults_arrived_share: results.arrived_share(),
            runs_without_effect: results.sum(|row| row.without_effect),
            digest: format!("{:016x}", results.digest),
            checks: Vec::new(),
            rows: results.rows.clone(),
            findings: findings
                .map(|(finding, number)| WrongRunSummary {
                    what: finding.run.description(),
                    silent_bad_exposures: finding.outcome.silent_bad(),
                    frame: finding.outcome.first_silent,
                    unanswered_triggers: finding.outcome.unanswered,
                    effect: finding.outcome.effect.clone(),
                    worst: finding.outcome.worst,
                    quantity: finding.outcome.worst_of.clone(),
                    scenario: scenario_name(number),
                })
                .collect(),
        };
        summary.checks = summary.limits();
        summary.passed = summary.checks.iter().all(|check| check.passed);
        summary
    }

    fn limits(&self) -> Vec<LimitCheck> {
        let runs = self.runs + self.pairs;
        let bad = match self.request.allowed {
            1.0.. => "silent bad exposures".to_owned(),
            allowed => format!("exposures beyond {allowed} of what is allowed"),
        };
        let counts = [
            (bad, self.silent_bad_exposures),
            (
                "triggers without a record".to_owned(),
                self.unanswered_triggers,
            ),
        ];
        let mut checks: Vec<LimitCheck> = counts
            .map(|(what, count)| LimitCheck {
                what,
                found: wording::count(u64::from(count)),
                limit: "0".to_owned(),
                // A check over nothing is not passed.
                passed: count == 0 && runs > 0,
            })
            .to_vec();
        checks.push(LimitCheck {
            what: "fault that arrives least often".to_owned(),
            found: percent(self.faults_arrived_share),
            limit: format!("at least {}", percent(LEAST_ARRIVED)),
            passed: self.runs > 0 && self.faults_arrived_share >= LEAST_ARRIVED,
        });
        checks
    }
}

/// Returns the name of the scenario of a finding, numbered from 1.
#[must_use]
pub fn scenario_name(number: u32) -> String {
    format!("finding-{number:02}.toml")
}

/// Rounds down: a share below a limit does not look like the limit.
fn percent(share: f64) -> String {
    format!(
        "{} %",
        wording::decimals((1000.0 * share).floor() / 10.0, 1)
    )
}
