//! Tables of documents, for comparison with the committed tables.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::comparison::Row;
use super::cost::{self, Cost as _, Footprint, Instructions};
use super::cycles::KERNELS;

/// Compiler whose counts the documents quote; the tables may also have rows of others.
pub(crate) const COMPILER: &str = "rustc 1.96.0";

/// Reads a committed table.
pub(crate) fn table<T: DeserializeOwned>(path: &str) -> Vec<T> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    cost::read(&root.join(path)).unwrap()
}

/// Reads the committed tables, with the rows of every compiler.
pub(crate) fn tables() -> (Vec<Instructions>, Vec<Footprint>) {
    (table(Instructions::TABLE), table(Footprint::TABLE))
}

/// Returns the rows of the table of instructions that the documents quote.
pub(crate) fn instructions() -> Vec<Instructions> {
    let mut rows = tables().0;
    rows.retain(|row| row.compiler == COMPILER);
    rows
}

/// Returns one of the quoted counts.
pub(crate) fn count(core: &str, kernel: &str) -> f64 {
    let rows = instructions();
    let is_it = |row: &&Instructions| row.core == core && row.kernel == kernel;
    let row = rows.iter().find(is_it);
    row.unwrap_or_else(|| panic!("{kernel} on {core}")).count
}

/// Returns the cells of the table rows under this line of a document.
pub(crate) fn rows(document: &'static str, heading: &str) -> Vec<Vec<&'static str>> {
    let tables = document.split(heading).skip(1);
    tables
        .flat_map(|table| {
            let rows = table.lines().skip(2);
            rows.take_while(|line| line.starts_with('|'))
        })
        .map(|line| line.split('|').map(str::trim).skip(1).collect())
        .collect()
}

#[test]
fn counts_of_every_core_are_those_of_the_committed_table() {
    const CORES: [&str; 3] = ["cortex-m4f", "cortex-m7", "cortex-m55"];
    let documented = rows(
        include_str!("../../../docs/performance.md"),
        "| row | cortex-m4f | cortex-m7 | cortex-m55 |",
    );
    assert!(documented.len() > 15);
    for row in documented {
        let kernel = row[0].trim_matches('`');
        for (core, count) in CORES.into_iter().zip(&row[1..]) {
            let counted = super::documented::count(core, kernel);
            assert_eq!(counted.to_string(), *count, "{kernel} on {core}");
        }
    }
}

#[test]
fn documented_times_are_those_of_the_committed_table() {
    let table: Vec<Row> = table("docs/performance.csv");
    let documented = rows(
        include_str!("../../../docs/performance.md"),
        "| | 1e3 points | 1e5 | 1e7 | by copying, 1e7 |",
    );
    assert!(documented.len() > 8);
    for row in documented {
        let kernel = row[0].trim_matches('`');
        let of = |points| {
            let is_it = |row: &&Row| row.kernel == kernel && row.points == Some(points);
            table.iter().find(is_it).unwrap()
        };
        let times =
            [1000, 100_000, 10_000_000].map(|points| format!("{:.2}", of(points).ns.unwrap()));
        assert_eq!(row[1..4], times, "{kernel}");
        let copying = of(10_000_000).of_memcpy.map(|ratio| format!("{ratio:.2}"));
        assert_eq!(row[4], copying.unwrap_or_default(), "{kernel}");
    }
}

#[test]
fn operations_are_those_by_which_loops_are_found() {
    let documented = rows(
        include_str!("../../../docs/performance.md"),
        "| form | multiplications | additions and subtractions | together |",
    );
    assert_eq!(documented.len(), 2);
    for (row, kernel) in documented
        .iter()
        .zip(["correct_slice", "correct_slice_full"])
    {
        let of = KERNELS.iter().find(|known| known.row == kernel);
        let numbers: Vec<u32> = row[1..4].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(numbers[0] + numbers[1], numbers[2], "{kernel}");
        assert_eq!(of.map(|known| known.operations), Some(numbers[2]));
    }
}
