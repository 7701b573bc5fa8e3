//! Numbers in documents, held against the committed tables.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::comparison::Row;
use super::cost::{self, Instructions};

/// A committed table.
pub(crate) fn table<T: DeserializeOwned>(path: &str) -> Vec<T> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    cost::read(&root.join(path)).unwrap()
}

/// The committed table of instructions.
pub(crate) fn instructions() -> Vec<Instructions> {
    table("docs/instructions.csv")
}

/// Cells of the rows of the tables under this line of a document.
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
    let table = instructions();
    let documented = rows(
        include_str!("../../../docs/performance.md"),
        "| row | cortex-m4f | cortex-m7 | cortex-m55 |",
    );
    assert!(documented.len() > 15);
    for row in documented {
        let kernel = row[0].trim_matches('`');
        for (core, count) in CORES.into_iter().zip(&row[1..]) {
            let is_it = |row: &&Instructions| row.core == core && row.kernel == kernel;
            let counted = table.iter().find(is_it).map(|row| row.count.to_string());
            assert_eq!(counted.as_deref(), Some(*count), "{kernel} on {core}");
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
fn costs_in_the_documentation_of_rows_are_those_of_the_committed_table() {
    let text = include_str!("../../../src/geometry/mesh/displacement_rows.rs");
    let of = |kernel: &str| {
        let rows = instructions();
        let is_it = |row: &&Instructions| row.core == "cortex-m4f" && row.kernel == kernel;
        rows.iter().find(is_it).map(|row| row.count).unwrap()
    };
    let rounded = |number: f64| 100.0 * (number / 100.0).round();
    for claim in [
        format!(
            "/// {:.0} instructions per point on a Cortex-M4F",
            of("mesh_row")
        ),
        format!(
            "{:.0} per row and {:.0} per frame",
            of("mesh_row_setup"),
            rounded(of("mesh_rows_setup"))
        ),
    ] {
        assert!(text.contains(&claim), "{claim}");
    }
}
