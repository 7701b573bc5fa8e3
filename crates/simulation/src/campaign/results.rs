//! Results of a campaign, row by row of its heat map.

use std::collections::BTreeMap;

use serde::Serialize;

use super::outcome::Outcome;
use super::plan::{Plan, Run};
use super::world::INTERVAL_MS;

/// Rounds of the frame cycle that a cell of the heat map holds.
pub const CELL_MS: u32 = 5;
/// Name of the row of pairs.
pub const PAIRS: &str = "pairs of faults";
/// Largest number of findings of a row that are repeated by a scenario.
const MOST_REPEATED: usize = 3;

/// All runs of one kind of fault.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Row {
    /// Name of the fault, with what it affects.
    pub name: String,
    /// Number of runs.
    pub runs: u32,
    /// Number of runs in which the camera was told something else than without the fault.
    pub arrived: u32,
    /// Number of runs without an effect.
    pub without_effect: u32,
    /// Number of exposures that are wrong and say nothing of it.
    pub silent_bad_exposures: u32,
    /// Number of triggers without their record.
    pub unanswered_triggers: u32,
    /// Largest part of what a record without fault or flag allows that an error takes; `None`
    /// without such a record.
    pub worst: Option<f64>,
    /// Number of runs by their first effect.
    pub effects: BTreeMap<String, u32>,
    /// The largest part by the phase of the onset in the frame cycle; `None` without such records.
    #[serde(skip)]
    pub cells: Vec<Option<f64>>,
}

/// A run in which something is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct WrongRun {
    /// Name of its row.
    pub row: String,
    /// The run.
    pub run: Run,
    /// Its outcome.
    pub outcome: Outcome,
}

/// Results of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Results {
    /// Number of runs with one fault.
    pub runs: u32,
    /// Number of runs with two.
    pub pairs: u32,
    /// Rows: faults in the order of the cases, then the pairs.
    pub rows: Vec<Row>,
    /// Runs in which something is wrong, of each row the first.
    pub findings: Vec<WrongRun>,
    /// CRC-64 of all outcomes, in order.
    pub digest: u64,
}

impl Results {
    /// Collects the outcomes of all blocks of a plan, in their order.
    ///
    /// # Errors
    /// Those of [`Outcome::write_rows`].
    pub fn of(plan: &Plan, outcomes: &[Vec<Outcome>]) -> csv::Result<Self> {
        let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
        let mut digest = crc.digest();
        let mut results = Self {
            runs: 0,
            pairs: 0,
            rows: Vec::new(),
            findings: Vec::new(),
            digest: 0,
        };
        let mut names: Vec<String> = plan.cases.iter().map(super::case::Case::row).collect();
        names.dedup();
        names.push(PAIRS.to_owned());
        let cells = usize::try_from(INTERVAL_MS.div_ceil(CELL_MS)).unwrap_or(0);
        results.rows = names
            .into_iter()
            .map(|name| Row {
                name,
                cells: vec![None; cells],
                ..Row::default()
            })
            .collect();
        for (block, outcomes) in plan.blocks().into_iter().zip(outcomes) {
            digest.update(Outcome::write_rows(outcomes)?.as_bytes());
            for (run, outcome) in plan.runs(block).into_iter().zip(outcomes) {
                results.add(run, outcome);
            }
        }
        results.rows.retain(|row| row.runs > 0);
        results.digest = digest.finalize();
        Ok(results)
    }

    fn add(&mut self, run: Run, outcome: &Outcome) {
        let name = if let [(case, _)] = run.faults.as_slice() {
            self.runs += 1;
            case.row()
        } else {
            self.pairs += 1;
            PAIRS.to_owned()
        };
        let Some(row) = self.rows.iter_mut().find(|row| row.name == name) else {
            return;
        };
        row.runs += 1;
        row.arrived += u32::from(outcome.arrived_ms.is_some());
        row.without_effect += u32::from(outcome.effect == Outcome::NO_EFFECT);
        row.silent_bad_exposures += outcome.silent_bad();
        row.unanswered_triggers += outcome.unanswered;
        *row.effects.entry(outcome.effect.clone()).or_default() += 1;
        if let Some(worst) = outcome.worst {
            let larger = |before: Option<f64>| Some(before.map_or(worst, |one| one.max(worst)));
            row.worst = larger(row.worst);
            let cell = usize::try_from(run.tick % INTERVAL_MS / CELL_MS).ok();
            if let Some(cell) = cell.and_then(|cell| row.cells.get_mut(cell)) {
                *cell = larger(*cell);
            }
        }
        let is_wrong = outcome.silent_bad() > 0 || outcome.unanswered > 0;
        let of_row = self.findings.iter().filter(|finding| finding.row == name);
        if is_wrong && of_row.count() < MOST_REPEATED {
            self.findings.push(WrongRun {
                row: name,
                run,
                outcome: outcome.clone(),
            });
        }
    }

    /// Returns the smallest share of the runs of any one fault in which it arrived.
    #[must_use]
    pub fn arrived_share(&self) -> f64 {
        self.rows
            .iter()
            .filter(|row| row.name != PAIRS)
            .map(|row| f64::from(row.arrived) / f64::from(row.runs))
            .fold(1.0, f64::min)
    }

    /// Sums a count over all rows.
    pub fn sum(&self, count: impl Fn(&Row) -> u32) -> u32 {
        self.rows.iter().map(count).sum()
    }
}
