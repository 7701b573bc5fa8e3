//! `docs/safety.md`: every fault, every scenario's fault and every flag has its row, and every test
//! that a row names exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Flag;
use fmc_simulation::mission::fault::InjectedFault;

/// Folders in which tests are looked for.
const FOLDERS: [&str; 4] = ["src", "tests", "crates", "host-sim"];

/// A hazard, as the columns of its row.
struct Hazard {
    cells: Vec<String>,
}

impl Hazard {
    fn parts(&self, column: usize) -> impl Iterator<Item = String> {
        let cell = &self.cells[column];
        let parts = cell
            .split(", ")
            .map(|part| part.trim_matches('`').to_owned());
        parts.filter(|part| part != "—")
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn hazards() -> Vec<Hazard> {
    let text = fs::read_to_string(root().join("docs/safety.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| "));
    let hazards: Vec<Hazard> = rows
        .skip(1)
        .map(|line| {
            let cells = line.trim_matches('|').split('|');
            let cells: Vec<String> = cells.map(|cell| cell.trim().to_owned()).collect();
            assert_eq!(cells.len(), 6, "{line}");
            assert!(cells.iter().all(|cell| !cell.is_empty()), "{line}");
            Hazard { cells }
        })
        .collect();
    assert!(hazards.len() > 20);
    hazards
}

/// Returns what a column of all rows names.
fn named(column: usize) -> BTreeSet<String> {
    hazards().iter().flat_map(|row| row.parts(column)).collect()
}

#[test]
fn every_fault_code_has_its_hazard_and_every_hazard_a_fault_that_there_is() {
    let known = Fault::ALL.map(|fault| format!("{} {}", fault.code(), fault.name()));
    assert_eq!(named(2), BTreeSet::from(known));
}

#[test]
fn every_fault_of_a_scenario_has_its_hazard_and_every_hazard_one_that_there_is() {
    let known = InjectedFault::ALL.map(|fault| fault.name().to_owned());
    assert_eq!(named(3), BTreeSet::from(known));
}

#[test]
fn every_flag_of_a_record_has_its_hazard_and_every_hazard_one_that_there_is() {
    let known = Flag::ALL.map(|flag| flag.name().to_owned());
    assert_eq!(named(5), BTreeSet::from(known));
}

/// Collects the names of all functions that are tests.
fn tests_of(folder: &Path, names: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") {
            tests_of(&path, names);
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let mut is_test = false;
            for line in text.lines().map(str::trim) {
                if line == "#[test]" {
                    is_test = true;
                } else if let Some(name) = line.strip_prefix("fn ") {
                    if is_test && let Some((name, _)) = name.split_once("()") {
                        names.insert(name.to_owned());
                    }
                    is_test = false;
                }
            }
        }
    }
}

#[test]
fn every_test_that_a_hazard_names_exists_and_every_hazard_has_one() {
    let mut known = BTreeSet::new();
    for folder in FOLDERS {
        tests_of(&root().join(folder), &mut known);
    }
    let unknown: Vec<String> = named(4).difference(&known).cloned().collect();
    assert!(unknown.is_empty(), "{unknown:?}");
    for hazard in hazards() {
        assert!(hazard.parts(4).next().is_some(), "{}", hazard.cells[0]);
    }
    // A test that does not exist is found.
    assert!(!known.contains("test_that_nobody_has_written"));
}
