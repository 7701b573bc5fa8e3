//! Findings: costs that exceed the tables, and costs that cannot be compared.

use std::{collections::BTreeMap, fmt};

use super::{
    cost::Amount,
    limit::{self, LIMITS, Limit},
};

/// Relative rise of a cost above which the table has to change.
pub(crate) const MAX_RISE: f64 = 0.01;

/// Command that writes the tables, but not the limits.
const UPDATE: &str = "`cargo xtask bench --update`";

/// A finding.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CostProblem {
    /// A cost is larger than in the table.
    Dearer {
        name: String,
        unit: String,
        table: f64,
        now: f64,
    },
    /// A cost exceeds its limit.
    OverLimit {
        name: String,
        unit: String,
        limit: f64,
        now: f64,
    },
    /// A measured cost has no limit.
    NoLimit {
        on: String,
        cost: String,
        proposal: f64,
    },
    /// A limit belongs to a cost that is not measured.
    LimitOfNothing { on: String, cost: String },
    /// A measured cost is not in the table, which has others of the same compiler and core.
    NotInTable { name: String, table: &'static str },
    /// A cost of the table is not measured.
    NotMeasured { name: String, table: &'static str },
    /// No cost was measured.
    NothingMeasured,
}

impl fmt::Display for CostProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dearer {
                name,
                unit,
                table,
                now,
            } => write!(
                f,
                "{name}: {now} {unit}, the table says {table}; if that is right, {UPDATE} writes it"
            ),
            Self::OverLimit {
                name,
                unit,
                limit,
                now,
            } => write!(
                f,
                "{name}: {now} {unit}, the limit is {limit} for every compiler"
            ),
            Self::NoLimit { on, cost, proposal } => write!(
                f,
                "{cost} on {on}: it has no limit; set one by hand in {LIMITS}, such as `{on},{cost},{proposal},margin`"
            ),
            Self::LimitOfNothing { on, cost } => write!(
                f,
                "{cost} on {on}: it has a limit in {LIMITS}, but was not measured; if it is gone, take the line out by hand"
            ),
            Self::NotInTable { name, table } => {
                write!(f, "{name}: {table} has no row of it; {UPDATE} adds it")
            }
            Self::NotMeasured { name, table } => write!(
                f,
                "{name}: it has a row in {table}, but was not measured; if it is gone, {UPDATE} takes the row out"
            ),
            Self::NothingMeasured => write!(f, "nothing was measured that could be compared"),
        }
    }
}

/// Compares the measured costs with the limits and with the rows of the same compiler and core. If
/// the table has no such rows, only the limits apply, and [`notes`] says so.
pub(crate) fn findings(
    table: &[Amount<'_>],
    limits: &[Limit],
    measured: &[Amount<'_>],
) -> Vec<CostProblem> {
    if measured.is_empty() {
        return vec![CostProblem::NothingMeasured];
    }
    let mut findings = limit::held(limits, measured);
    let is_in =
        |rows: &[Amount<'_>], row: &Amount<'_>| rows.iter().any(|other| other.is_of_group_of(row));
    for now in measured.iter().filter(|row| is_in(table, row)) {
        let mut group = table.iter().filter(|row| row.is_of_group_of(now));
        match group.find(|row| row.is_of_same(now)) {
            None => findings.push(CostProblem::NotInTable {
                name: now.to_string(),
                table: now.table,
            }),
            Some(known) if now.count > known.count * (1.0 + MAX_RISE) => {
                findings.push(CostProblem::Dearer {
                    name: now.to_string(),
                    unit: now.unit.clone(),
                    table: known.count,
                    now: now.count,
                });
            }
            Some(_) => {}
        }
    }
    for known in table.iter().filter(|row| is_in(measured, row)) {
        let mut group = measured.iter().filter(|now| now.is_of_group_of(known));
        if !group.any(|now| now.is_of_same(known)) {
            findings.push(CostProblem::NotMeasured {
                name: known.to_string(),
                table: known.table,
            });
        }
    }
    findings
}

/// Returns notes on what the comparison leaves out: the rows of compilers that the tables do not
/// have, and the limits of costs that were not measured.
pub(crate) fn notes(
    table: &[Amount<'_>],
    limits: &[Limit],
    measured: &[Amount<'_>],
) -> Vec<String> {
    let mut missing: BTreeMap<_, usize> = BTreeMap::new();
    let is_known = |now: &Amount<'_>| table.iter().any(|row| row.is_of_group_of(now));
    for now in measured.iter().filter(|now| !is_known(now)) {
        *missing
            .entry((now.table, now.on, now.compiler))
            .or_default() += 1;
    }
    let missing = missing.into_iter().map(|((table, on, compiler), count)| {
        format!(
            "{table} has none of the {count} costs on {on} by {compiler}: they are held to the limits alone; {UPDATE} adds them"
        )
    });
    let passed_over = limit::passed_over(limits, measured).into_iter();
    let passed_over = passed_over.map(|(on, count)| {
        format!("nothing was measured on {on}: its {count} limits are passed over")
    });
    missing.chain(passed_over).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cost::{Cost as _, Instructions, amounts};
    use super::super::limit::{Limit, SetBy};
    use super::{CostProblem, findings, notes};

    fn row_on(core: &str, kernel: &str, count: f64, compiler: &str) -> Instructions {
        Instructions {
            core: core.to_owned(),
            kernel: kernel.to_owned(),
            count,
            unit: "point".to_owned(),
            compiler: compiler.to_owned(),
        }
    }

    fn row(kernel: &str, count: f64, compiler: &str) -> Instructions {
        row_on("cortex-m4f", kernel, count, compiler)
    }

    /// Creates limits of every kernel on every core.
    fn limits(limits: &[(&str, &str, f64)]) -> Vec<Limit> {
        let limits = limits.iter().map(|(on, cost, limit)| Limit {
            on: (*on).to_owned(),
            cost: (*cost).to_owned(),
            most: *limit,
            set_by: SetBy::Margin,
        });
        limits.collect()
    }

    fn compare(
        table: &[Instructions],
        limits: &[Limit],
        measured: &[Instructions],
    ) -> Vec<CostProblem> {
        findings(&amounts(table), limits, &amounts(measured))
    }

    #[test]
    fn one_percent_more_is_let_pass_and_two_are_not() {
        let table = [row("distort", 100.0, "1.96")];
        let limits = limits(&[("cortex-m4f", "distort", 300.0)]);
        for (now, passes) in [(50.0, true), (101.0, true), (101.1, false), (200.0, false)] {
            let findings = compare(&table, &limits, &[row("distort", now, "1.96")]);
            assert_eq!(findings.is_empty(), passes, "{now}");
        }
    }

    #[test]
    fn other_compiler_is_held_to_every_limit_and_its_missing_rows_are_said() {
        let table = [row("a", 20.0, "1.96"), row("b", 20.0, "1.96")];
        let limits = limits(&[("cortex-m4f", "a", 25.0), ("cortex-m4f", "b", 25.0)]);
        let other = [row("a", 25.0, "1.95"), row("b", 25.0, "1.95")];
        assert_eq!(compare(&table, &limits, &other), []);
        let expected = "docs/instructions.csv has none of the 2 costs on cortex-m4f by 1.95: they are held to the limits alone; `cargo xtask bench --update` adds them";
        let said = notes(&amounts(&table), &limits, &amounts(&other));
        assert_eq!(said, [expected]);
        let dear = [row("a", 25.0, "1.95"), row("b", 25.1, "1.95")];
        let findings = compare(&table, &limits, &dear);
        assert!(matches!(findings[..], [CostProblem::OverLimit { .. }]));
    }

    #[test]
    fn every_compiler_of_the_table_has_rows_of_its_own_and_the_same_limit() {
        let both = [row("a", 20.0, "1.96"), row("a", 24.0, "1.95")];
        let limits = limits(&[("cortex-m4f", "a", 25.0)]);
        assert_eq!(compare(&both, &limits, &[row("a", 24.1, "1.95")]), []);
        let findings = compare(&both, &limits, &[row("a", 24.4, "1.95")]);
        assert!(matches!(findings[..], [CostProblem::Dearer { .. }]));
        let over = compare(&both, &limits, &[row("a", 25.1, "1.95")]);
        assert!(matches!(
            over[..],
            [CostProblem::OverLimit { .. }, CostProblem::Dearer { .. }]
        ));
        let none = notes(&amounts(&both), &limits, &amounts(&both[1..]));
        assert_eq!(none, [""; 0]);
    }

    #[test]
    fn cores_that_were_not_counted_are_passed_over_by_name() {
        let m4f = [row("a", 24.0, "1.96")];
        let m55 = row_on("cortex-m55", "a", 7.0, "1.96");
        let both = [m4f[0].clone(), m55];
        let limits = limits(&[("cortex-m4f", "a", 25.0), ("cortex-m55", "a", 7.1)]);
        assert_eq!(compare(&both, &limits, &m4f), []);
        let said = notes(&amounts(&both), &limits, &amounts(&m4f));
        let expected = "nothing was measured on cortex-m55: its 1 limits are passed over";
        assert_eq!(said, [expected]);
        // A table without these rows causes only a note, and the limit applies.
        assert_eq!(compare(&m4f, &limits, &both), []);
        assert_eq!(notes(&amounts(&m4f), &limits, &amounts(&both)).len(), 1);
        let dear = row_on("cortex-m55", "a", 7.2, "1.96");
        let findings = compare(&m4f, &limits, &[m4f[0].clone(), dear]);
        assert!(matches!(findings[..], [CostProblem::OverLimit { .. }]));
    }

    #[test]
    fn rows_without_a_counterpart_are_named_with_the_command() {
        let limits = limits(&[("cortex-m4f", "b", 1.0)]);
        let found = compare(&[row("a", 1.0, "")], &limits, &[row("b", 1.0, "")]);
        let names: Vec<_> = found.iter().map(ToString::to_string).collect();
        let [missing, gone] = [
            "b on cortex-m4f: docs/instructions.csv has no row of it; `cargo xtask bench --update` adds it",
            "a on cortex-m4f: it has a row in docs/instructions.csv, but was not measured; if it is gone, `cargo xtask bench --update` takes the row out",
        ];
        assert_eq!(names, [missing, gone]);
    }

    #[test]
    fn comparison_of_nothing_is_no_pass() {
        let table = [row("a", 1.0, "")];
        let limits = limits(&[("cortex-m4f", "a", 1.0)]);
        assert_eq!(
            compare(&table, &limits, &[]),
            [CostProblem::NothingMeasured]
        );
        assert_eq!(compare(&[], &[], &[]), [CostProblem::NothingMeasured]);
        // A table without limits does not pass either.
        let findings = compare(&table, &[], &table);
        assert!(matches!(findings[..], [CostProblem::NoLimit { .. }]));
        assert_eq!(table[0].amounts().len(), 1);
    }
}
