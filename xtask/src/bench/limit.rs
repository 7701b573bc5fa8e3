//! Limits of the cost of the camera's work, by whichever compiler: `docs/limits.csv`.
//!
//! A count depends on the compiler, so a row of a table is compared only with rows of the same
//! compiler. A limit belongs to the camera: every row has one, and every compiler has to keep it.

use std::{collections::BTreeSet, path::Path};

use anyhow::Result;
use serde::Deserialize;

use super::{
    cost::{self, Amount},
    cost_problem::CostProblem,
};

/// Path of the limits. They are set by hand: this program does not write them.
pub(crate) const LIMITS: &str = "docs/limits.csv";

/// Factor from the first count to the proposed limit of a new row: the same code was found to cost
/// up to 24 % more where the compiler joined other functions (`docs/performance.md`).
pub(crate) const MARGIN: f64 = 1.25;

/// Least margin of an event or tick of the control loop: passing it and its actions in registers or
/// in memory makes a difference of up to 240 instructions to each, however few it takes otherwise.
pub(crate) const LEAST_OF_A_STEP: f64 = 240.0;

/// Largest ratio of a limit to the largest count of its row: a looser limit is meaningless and has
/// to be lowered.
#[cfg(test)]
pub(crate) const LOOSEST: f64 = 1.38;

/// Line of the limits. It can be read but not written.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct Limit {
    /// Core or image.
    pub(crate) on: String,
    /// Kernel, or column of an image.
    pub(crate) cost: String,
    #[serde(rename = "limit")]
    pub(crate) most: f64,
    pub(crate) set_by: SetBy,
}

/// Origin of a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SetBy {
    /// Requirement of the camera.
    Requirement,
    /// Margin over the first count.
    Margin,
}

impl Limit {
    fn is_of(&self, amount: &Amount<'_>) -> bool {
        (self.on.as_str(), self.cost.as_str()) == (amount.on, amount.cost)
    }
}

/// Reads the limits.
///
/// # Errors
/// An error if they are missing or are not such a table.
pub(crate) fn read(root: &Path) -> Result<Vec<Limit>> {
    cost::read(&root.join(LIMITS))
}

/// Returns the proposed limit of a row: its count and the margin, in two digits.
pub(crate) fn proposal(row: &Amount<'_>) -> f64 {
    let least = if is_step(row) { LEAST_OF_A_STEP } else { 0.0 };
    two_digits_up((MARGIN * row.count).max(row.count + least))
}

/// Returns true for an event or a tick of the control loop, which are counted singly.
fn is_step(row: &Amount<'_>) -> bool {
    row.cost.starts_with("control_event_") || row.cost.starts_with("control_tick_")
}

/// Rounds up to two significant digits; nothing remains nothing.
fn two_digits_up(number: f64) -> f64 {
    if number <= 0.0 {
        return 0.0;
    }
    let digit = number.log10().floor() - 1.0;
    if digit < 0.0 {
        let scale = 10_f64.powf(-digit);
        (number * scale).ceil() / scale
    } else {
        let unit = 10_f64.powf(digit);
        (number / unit).ceil() * unit
    }
}

/// Returns the costs that exceed their limit or have none, and the limits without a cost on a core
/// or image that was measured.
pub(crate) fn held(limits: &[Limit], measured: &[Amount<'_>]) -> Vec<CostProblem> {
    let mut findings = Vec::new();
    for now in measured {
        let limit = limits.iter().find(|limit| limit.is_of(now));
        match limit.map(|limit| limit.most) {
            Some(limit) if now.count <= limit => {}
            Some(limit) => findings.push(CostProblem::OverLimit {
                name: now.to_string(),
                unit: now.unit.clone(),
                limit,
                now: now.count,
            }),
            None => findings.push(CostProblem::NoLimit {
                on: now.on.to_owned(),
                cost: now.cost.to_owned(),
                proposal: proposal(now),
            }),
        }
    }
    for limit in limits {
        let is_on = measured.iter().any(|now| now.on == limit.on);
        if is_on && !measured.iter().any(|now| limit.is_of(now)) {
            findings.push(CostProblem::LimitOfNothing {
                on: limit.on.clone(),
                cost: limit.cost.clone(),
            });
        }
    }
    findings
}

/// Returns the cores and images that were not measured, each with the number of its limits.
pub(crate) fn passed_over<'a>(
    limits: &'a [Limit],
    measured: &[Amount<'_>],
) -> Vec<(&'a str, usize)> {
    let is_measured = |on: &str| measured.iter().any(|now| now.on == on);
    let of = |on| limits.iter().filter(|limit| limit.on == on).count();
    let all: BTreeSet<_> = limits.iter().map(|limit| limit.on.as_str()).collect();
    let others = all.into_iter().filter(|on| !is_measured(on));
    others.map(|on| (on, of(on))).collect()
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fs, path::Path};

    use super::super::{
        cost::{self, Cost as _, Footprint, Instructions, amounts},
        documented,
    };
    use super::{
        LEAST_OF_A_STEP, LIMITS, LOOSEST, Limit, SetBy, held, is_step, passed_over, proposal,
        two_digits_up,
    };

    /// Largest ratio for a step of the control loop, which allows for the two digits of its least
    /// margin.
    const LOOSEST_OF_A_STEP: f64 = 1.1;

    fn limits() -> Vec<Limit> {
        documented::table(LIMITS)
    }

    fn row(core: &str, kernel: &str, count: f64) -> Instructions {
        Instructions {
            core: core.to_owned(),
            kernel: kernel.to_owned(),
            count,
            unit: "point".to_owned(),
            compiler: "1.96".to_owned(),
        }
    }

    fn limit(on: &str, cost: &str, most: f64) -> Limit {
        Limit {
            on: on.to_owned(),
            cost: cost.to_owned(),
            most,
            set_by: SetBy::Margin,
        }
    }

    fn texts(limits: &[Limit], rows: &[Instructions]) -> Vec<String> {
        let findings = held(limits, &amounts(rows));
        findings.iter().map(ToString::to_string).collect()
    }

    /// Every compiler's row is within its limit, every row has one, and every limit has a row.
    #[test]
    fn committed_tables_keep_every_limit() {
        let (instructions, footprint) = documented::tables();
        assert_eq!(held(&limits(), &amounts(&instructions)), []);
        assert_eq!(held(&limits(), &amounts(&footprint)), []);
        let all = [amounts(&instructions), amounts(&footprint)].concat();
        assert_eq!(passed_over(&limits(), &all), []);
    }

    #[test]
    fn limits_are_close_enough_to_say_something() {
        let (instructions, footprint) = documented::tables();
        let all = [amounts(&instructions), amounts(&footprint)].concat();
        for limit in limits() {
            let rows = all.iter().filter(|row| limit.is_of(row));
            let loosest = rows.map(|row| {
                let of_a_step = LOOSEST_OF_A_STEP * (row.count + LEAST_OF_A_STEP);
                let of_a_step = if is_step(row) { of_a_step } else { 0.0 };
                of_a_step.max(LOOSEST * row.count)
            });
            assert!(limit.most <= loosest.fold(0.0, f64::max), "{limit:?}");
            let two_digits = two_digits_up(limit.most).to_string();
            assert_eq!(limit.most.to_string(), two_digits, "{limit:?}");
        }
    }

    #[test]
    fn every_row_has_one_limit() {
        let limits = limits();
        let named: BTreeSet<_> = limits.iter().map(|one| (&one.on, &one.cost)).collect();
        assert_eq!(named.len(), limits.len());
    }

    /// Requirements are stated in the document, too, so that they are not changed in passing.
    #[test]
    fn requirements_are_those_that_are_documented() {
        let documented = documented::rows(
            include_str!("../../../docs/performance.md"),
            "| at most | cortex-m4f | cortex-m7 | cortex-m55 |",
        );
        let mut named = BTreeSet::new();
        for row in documented {
            let kernel = row[0].trim_matches('`');
            let cores = ["cortex-m4f", "cortex-m7", "cortex-m55"];
            for (core, cell) in cores.into_iter().zip(&row[1..]) {
                if !cell.is_empty() {
                    named.insert((core.to_owned(), kernel.to_owned(), (*cell).to_owned()));
                }
            }
        }
        let required = limits()
            .into_iter()
            .filter(|limit| limit.set_by == SetBy::Requirement)
            .map(|limit| (limit.on, limit.cost, limit.most.to_string()));
        assert_eq!(named, required.collect());
        assert!(named.len() >= 42);
    }

    #[test]
    fn proposals_have_two_digits_and_the_margin() {
        for (kernel, count, expected) in [
            ("kernel", 7.08, "8.9"),
            ("kernel", 24.06, "31"),
            ("kernel", 100.0, "130"),
            ("kernel", 240.0, "300"),
            ("control_event_kind", 240.0, "480"),
            ("control_tick_kind", 8080.0, "11000"),
            ("kernel", 108_400.0, "140000"),
        ] {
            let row = row("cortex-m4f", kernel, count);
            assert_eq!(proposal(&row.amounts()[0]).to_string(), expected);
        }
    }

    #[test]
    fn row_without_a_limit_is_named_with_the_line_that_is_missing() {
        let limits = [limit("cortex-m4f", "known", 10.0)];
        let rows = [
            row("cortex-m4f", "known", 10.0),
            row("cortex-m4f", "new", 10.0),
        ];
        let expected = "new on cortex-m4f: it has no limit; set one by hand in docs/limits.csv, such as `cortex-m4f,new,13,margin`";
        assert_eq!(texts(&limits, &rows), [expected]);
    }

    #[test]
    fn limit_of_nothing_is_named_on_the_cores_that_were_counted() {
        let limits = [
            limit("cortex-m4f", "known", 10.0),
            limit("cortex-m4f", "gone", 10.0),
            limit("cortex-m55", "known", 3.0),
        ];
        let rows = [row("cortex-m4f", "known", 9.0)];
        let expected = "gone on cortex-m4f: it has a limit in docs/limits.csv, but was not measured; if it is gone, take the line out by hand";
        assert_eq!(texts(&limits, &rows), [expected]);
        assert_eq!(passed_over(&limits, &amounts(&rows)), [("cortex-m55", 1)]);
    }

    #[test]
    fn limit_itself_is_let_pass_and_more_is_not() {
        let limits = [limit("cortex-m4f", "kernel", 10.0)];
        assert_eq!(
            texts(&limits, &[row("cortex-m4f", "kernel", 10.0)]),
            [""; 0]
        );
        let expected = "kernel on cortex-m4f: 10.01 instructions per point, the limit is 10 for every compiler";
        let found = texts(&limits, &[row("cortex-m4f", "kernel", 10.01)]);
        assert_eq!(found, [expected]);
    }

    #[test]
    fn images_have_limits_of_flash_variables_and_stack() {
        let image = Footprint {
            image: "mps2".to_owned(),
            flash_bytes: 100,
            static_ram_bytes: 11,
            stack_used_bytes: 12,
            stack_bound_bytes: Some(13),
            compiler: String::new(),
        };
        let limits = [
            limit("mps2", "flash_bytes", 100.0),
            limit("mps2", "static_ram_bytes", 10.0),
        ];
        let findings = held(&limits, &image.amounts());
        let texts: Vec<_> = findings.iter().map(ToString::to_string).collect();
        let [over, without, bound] = [
            "static_ram_bytes on mps2: 11 bytes, the limit is 10 for every compiler",
            "stack_used_bytes on mps2: it has no limit; set one by hand in docs/limits.csv, such as `mps2,stack_used_bytes,15,margin`",
            "stack_bound_bytes on mps2: it has no limit; set one by hand in docs/limits.csv, such as `mps2,stack_bound_bytes,17,margin`",
        ];
        assert_eq!(texts, [over, without, bound]);
    }

    /// A larger count goes into the table, and still exceeds its limit.
    #[test]
    fn update_of_a_table_leaves_the_limits_alone() {
        let root = std::env::temp_dir().join(format!("fmc-xtask-limits-{}", std::process::id()));
        fs::create_dir_all(root.join("docs")).unwrap();
        let text = "on,cost,limit,set_by\ncortex-m4f,kernel,10,requirement\n";
        fs::write(root.join(LIMITS), text).unwrap();
        cost::replace(&root, vec![row("cortex-m4f", "kernel", 9.0)]).unwrap();
        cost::replace(&root, vec![row("cortex-m4f", "kernel", 11.0)]).unwrap();
        let table: Vec<Instructions> = cost::read(&root.join(Instructions::TABLE)).unwrap();
        let limits = super::read(&root).unwrap();
        let limits_then = fs::read_to_string(root.join(LIMITS)).unwrap();
        fs::remove_dir_all(Path::new(&root)).unwrap();
        assert_eq!(limits_then, text);
        assert_eq!(table, [row("cortex-m4f", "kernel", 11.0)]);
        assert_eq!(texts(&limits, &table).len(), 1);
    }
}
