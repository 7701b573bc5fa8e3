//! The statistics for programs: `summary.json`.

use fmc_simulation::judge::coverage::Coverage;
use fmc_simulation::judge::quantity::Quantity;
use fmc_simulation::statistics::summary::{Case, Request, Statistics};
use serde::Serialize;

use crate::{limits::LimitCheck, wording};

/// Least root mean square of error/σ: with a smaller one σ is too large.
const LEAST_RMS: f64 = 0.8;
/// Largest share of frames whose true smear is above the predicted one.
const LARGEST_SMEAR_SHARE: f64 = 0.05;

/// The numbers of the statistics. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The request.
    pub request: Request,
    /// `true` if no limit is exceeded.
    pub passed: bool,
    /// Number of triggers.
    pub triggers: usize,
    /// Number of exposed frames.
    pub exposed: usize,
    /// Number of refused triggers.
    pub refused: usize,
    /// Number of draws of which no mission came.
    pub refused_draws: u32,
    /// Distribution of error/σ of every quantity.
    pub quantities: Vec<QuantitySummary>,
    /// Share of frames whose true smear is above the predicted one.
    pub smear_above_share: f64,
    /// Largest smear above the predicted one, px.
    pub smear_above_px: f64,
    /// Number of missions with a fault that nothing has caused.
    pub missions_with_spurious_faults: usize,
    /// Number of triggers without their record.
    pub unanswered: usize,
    /// Number of frames that are wrong without a flag.
    pub silent_frames: usize,
    /// Number of checks that had nothing to judge.
    pub vacuous_checks: usize,
    /// Number of missions that passed although nothing was judged.
    pub vacuous_passes: usize,
    /// Quantity that is compared with a limit.
    pub checks: Vec<LimitCheck>,
    /// Worst cases, with the scenarios that repeat them.
    pub cases: Vec<Case>,
}

/// Distribution of a quantity's errors in units of their σ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct QuantitySummary {
    /// The quantity.
    pub quantity: Quantity,
    /// Its distribution.
    pub coverage: Coverage,
}

impl Summary {
    /// Returns the summary of statistics.
    #[must_use]
    pub fn of(statistics: &Statistics) -> Self {
        let quantities: Vec<QuantitySummary> = Quantity::ALL
            .into_iter()
            .filter_map(|quantity| {
                let coverage = statistics.coverage(quantity)?;
                Some(QuantitySummary { quantity, coverage })
            })
            .collect();
        let smears = statistics.smears();
        let above = smears.iter().filter(|(predicted, smear)| smear > predicted);
        let excess = smears.iter().map(|(predicted, smear)| smear - predicted);
        let mut summary = Self {
            request: statistics.request,
            passed: false,
            triggers: statistics.sum(|mission| mission.triggers),
            exposed: smears.len(),
            refused: statistics.sum(|mission| mission.refused),
            refused_draws: statistics.refused_draws,
            smear_above_share: number(above.count()) / number(smears.len().max(1)),
            smear_above_px: excess.fold(f64::NEG_INFINITY, f64::max),
            missions_with_spurious_faults: statistics
                .sum(|mission| usize::from(!mission.spurious.is_empty())),
            unanswered: statistics.sum(|mission| mission.unanswered),
            silent_frames: statistics.sum(|mission| mission.silent.len()),
            vacuous_checks: statistics.sum(|mission| mission.vacuous.len()),
            vacuous_passes: statistics.sum(|mission| usize::from(mission.is_vacuous_pass)),
            checks: Vec::new(),
            cases: statistics.cases.clone(),
            quantities,
        };
        summary.checks = summary.limits();
        summary.passed = summary.checks.iter().all(|check| check.passed);
        summary
    }

    fn limits(&self) -> Vec<LimitCheck> {
        let mut checks = Vec::new();
        for quantity in Quantity::ALL {
            let found = self.quantities.iter().find(|one| one.quantity == quantity);
            checks.extend(of_quantity(quantity, found.map(|one| &one.coverage)));
        }
        checks.push(LimitCheck {
            what: "smear above the predicted one".to_owned(),
            found: percent(self.smear_above_share),
            limit: format!("at most {}", percent(LARGEST_SMEAR_SHARE)),
            passed: self.exposed > 0 && self.smear_above_share <= LARGEST_SMEAR_SHARE,
        });
        let counts = [
            (
                "missions with a spurious fault",
                self.missions_with_spurious_faults,
            ),
            ("triggers without a record", self.unanswered),
            ("silent frames", self.silent_frames),
            (
                "missions that pass with nothing to judge",
                self.vacuous_passes,
            ),
        ];
        checks.extend(counts.map(|(what, count)| LimitCheck {
            what: what.to_owned(),
            found: wording::count(count as u64),
            limit: "0".to_owned(),
            passed: count == 0,
        }));
        checks
    }
}

/// Compares the distribution of a quantity with its limits.
fn of_quantity(quantity: Quantity, coverage: Option<&Coverage>) -> Vec<LimitCheck> {
    let name = quantity.name();
    let Some(coverage) = coverage else {
        return vec![LimitCheck {
            what: format!("{name}, error/σ"),
            found: "0 frames: nothing to judge".to_owned(),
            limit: String::new(),
            passed: false,
        }];
    };
    let share = |count: usize| number(count) / number(coverage.frames);
    let [beyond_3, beyond_5] = [share(coverage.beyond_3), share(coverage.beyond_5)];
    let most_rms = quantity.largest_rms();
    // The error of a stamp is a rounding, and its σ that of the receiver's pulse: it may be small.
    let least_rms = if quantity == Quantity::Utc {
        0.0
    } else {
        LEAST_RMS
    };
    let [most_3, most_5] = quantity.largest_shares();
    let check = |what: &str, found: String, limit: String, passed: bool| LimitCheck {
        what: format!("{name}, {what}"),
        found,
        limit,
        passed,
    };
    vec![
        check(
            "error/σ, RMS",
            format!("{:.2}", coverage.rms),
            format!("{least_rms} to {most_rms}"),
            (least_rms..=most_rms).contains(&coverage.rms),
        ),
        check(
            "beyond 3 σ",
            percent(beyond_3),
            format!("at most {}", percent(most_3)),
            beyond_3 <= most_3,
        ),
        check(
            "beyond 5 σ",
            percent(beyond_5),
            format!("at most {}", percent(most_5)),
            beyond_5 <= most_5,
        ),
    ]
}

/// Writes a share in per cent.
fn percent(share: f64) -> String {
    format!("{} %", wording::decimals(100.0 * share, 3))
}

fn number(count: usize) -> f64 {
    u32::try_from(count).map_or(f64::INFINITY, f64::from)
}
