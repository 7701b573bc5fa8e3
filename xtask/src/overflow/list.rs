//! List of the places that can overflow as far as the compiler can tell, with their bounds.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    path::Path,
};

use anyhow::{Context as _, Result};
use serde::Deserialize;

use super::place::Place;
use crate::source::{self, Sources};

/// The list.
pub(super) const LIST: &str = "docs/overflow.csv";

/// Compiler with which the list was made. Another one leaves checks elsewhere, since it bounds
/// other values itself.
pub(super) const MADE_WITH: &str = "rustc 1.96.0";

/// Part of the list with which a build is compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// `true` if the compiler is that of the list: otherwise numbers of places may differ, and rows
    /// may have none.
    pub(super) is_exact: bool,
    /// `true` if the core library was built, too.
    pub(super) has_core: bool,
}

/// Row of the list.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    file: String,
    function: String,
    operation: String,
    /// Number of places in the function.
    places: usize,
    /// Bound that keeps the values from the overflow.
    bound: String,
}

pub(super) fn read(root: &Path) -> Result<Vec<Row>> {
    let list = root.join(LIST);
    let mut reader = csv::Reader::from_path(&list).with_context(|| list.display().to_string())?;
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.with_context(|| list.display().to_string())
}

/// File, function and operation.
type Key = [String; 3];

/// Line, column and code of a place.
type Spot = (u32, u32, String);

/// Places that were found.
#[derive(Debug, Default)]
pub(super) struct Found(BTreeMap<Key, BTreeSet<Spot>>);

impl Found {
    pub(super) fn add(&mut self, place: Place, sources: &mut Sources) {
        let lines = sources.lines(&place.file);
        let function = source::function(lines, place.line).unwrap_or_default();
        let index = usize::try_from(place.line).unwrap_or_default();
        let code = index.checked_sub(1).and_then(|index| lines.get(index));
        let code = code.map_or("", |code| code.trim()).to_owned();
        let key = [source::file(&place.file), function, place.operation];
        let spots = self.0.entry(key).or_default();
        spots.insert((place.line, place.column, code));
    }

    /// Takes the places of a file away.
    pub(super) fn take(&mut self, file: &str) -> Self {
        let (taken, left) = std::mem::take(&mut self.0)
            .into_iter()
            .partition(|([of, ..], _)| of == file);
        self.0 = left;
        Self(taken)
    }

    /// Returns how the list differs from what was found.
    pub(super) fn faults(&self, rows: &[Row], extent: Extent) -> Vec<String> {
        let is_compared = |file: &str| extent.has_core || !is_core(file);
        let mut faults = vec![];
        let mut unlisted = self.0.clone();
        unlisted.retain(|[file, ..], _| is_compared(file));
        let mut listed = BTreeSet::new();
        for row in rows {
            let key = [&row.file, &row.function, &row.operation].map(String::clone);
            let name = key.join(", ");
            match unlisted.remove(&key) {
                Some(spots) if spots.len() != row.places && extent.is_exact => {
                    faults.push(format!(
                        "{name}: {LIST} states {} places, the code has {}:{}",
                        row.places,
                        spots.len(),
                        spots.iter().map(lines).collect::<String>()
                    ));
                }
                None if extent.is_exact && is_compared(&row.file) => {
                    faults.push(format!(
                        "{name}: no place of the code, though {LIST} has it"
                    ));
                }
                _ => {}
            }
            if row.bound.trim().is_empty() {
                faults.push(format!("{name}: {LIST} has no bound"));
            }
            if !listed.insert(key) {
                faults.push(format!("{name}: {LIST} has it twice"));
            }
        }
        faults.extend(unlisted.iter().map(|([file, function, operation], spots)| {
            let count = spots.len();
            let spots: String = spots.iter().map(lines).collect();
            format!("{file}, {function}, {operation}: {count} not in {LIST}:{spots}")
        }));
        faults
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let places: usize = self.0.values().map(BTreeSet::len).sum();
        let functions: BTreeSet<_> = self.0.keys().map(|[file, name, _]| (file, name)).collect();
        write!(f, "{places} places in {} functions", functions.len())
    }
}

fn lines((line, column, code): &Spot) -> String {
    format!("\n    line {line}:{column}: {code}")
}

fn is_core(file: &str) -> bool {
    ["core/", "compiler-builtins/"]
        .iter()
        .any(|library| file.starts_with(library))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Extent = Extent {
        is_exact: true,
        has_core: true,
    };

    fn found(places: &[(&str, &str, &str, u32)]) -> Found {
        let mut found = Found::default();
        for (file, function, operation, line) in places {
            let key = [file, function, operation].map(|one| (*one).to_owned());
            let spots = found.0.entry(key).or_default();
            spots.insert((*line, 9, "a + b".to_owned()));
        }
        found
    }

    fn row(file: &str, function: &str, operation: &str, places: usize, bound: &str) -> Row {
        Row {
            file: file.to_owned(),
            function: function.to_owned(),
            operation: operation.to_owned(),
            places,
            bound: bound.to_owned(),
        }
    }

    #[test]
    fn place_without_a_row_row_without_a_place_and_row_without_a_bound_are_faults() {
        let found = found(&[
            ("src/a.rs", "A::push", "add", 7),
            ("src/a.rs", "A::push", "add", 8),
            ("core/src/b.rs", "fmt", "sub", 1),
        ]);
        let rows = |places, bound| {
            vec![
                row("src/a.rs", "A::push", "add", places, bound),
                row("core/src/b.rs", "fmt", "sub", 1, "below 10"),
            ]
        };
        let faults = |rows: &[Row]| found.faults(rows, WHOLE);
        assert_eq!(faults(&rows(2, "below 8")), [""; 0]);
        let [fault] = &faults(&rows(1, "below 8"))[..] else {
            panic!("one fault");
        };
        assert!(
            fault.contains("states 1 places, the code has 2:"),
            "{fault}"
        );
        assert!(
            fault.contains("line 7:9: a + b\n    line 8:9: a + b"),
            "{fault}"
        );
        let [fault] = &faults(&rows(2, " "))[..] else {
            panic!("one fault");
        };
        assert!(fault.ends_with("has no bound"), "{fault}");
        let mut more = rows(2, "below 8");
        more.push(row("src/a.rs", "A::push", "sub", 1, "below 8"));
        let [fault] = &faults(&more)[..] else {
            panic!("one fault");
        };
        assert!(fault.starts_with("src/a.rs, A::push, sub: no place"));
        let [fault] = &faults(&more[1..2])[..] else {
            panic!("one fault");
        };
        assert!(
            fault.starts_with("src/a.rs, A::push, add: 2 not in docs"),
            "{fault}"
        );
        let mut twice = rows(2, "below 8");
        twice.extend(rows(2, "below 8"));
        assert!(
            faults(&twice)
                .iter()
                .filter(|fault| fault.ends_with("has it twice"))
                .count()
                == 2
        );
        // Another compiler may leave fewer checks, or more of them in a function that has a bound.
        let other = Extent {
            is_exact: false,
            ..WHOLE
        };
        assert_eq!(found.faults(&rows(1, "below 8"), other), [""; 0]);
        assert_eq!(found.faults(&more, other), [""; 0]);
        assert_eq!(found.faults(&more[1..2], other).len(), 1);
        assert_eq!(found.faults(&rows(2, ""), other).len(), 1);
    }

    #[test]
    fn control_is_taken_from_the_places_and_is_not_in_the_list() {
        let mut found = found(&[
            ("src/a.rs", "f", "add", 7),
            ("control.rs", "sum", "add", 17),
        ]);
        let control = found.take("control.rs");
        let rows = [row("src/a.rs", "f", "add", 1, "below 8")];
        assert_eq!(found.faults(&rows, WHOLE), [""; 0]);
        let faults = control.faults(&rows, WHOLE);
        let is_named = |fault: &String| fault.starts_with("control.rs, sum, add: 1 not in");
        assert!(faults.iter().any(is_named), "{faults:?}");
    }

    #[test]
    fn rows_of_the_core_library_stay_where_it_came_compiled() {
        let found = found(&[
            ("src/a.rs", "f", "add", 7),
            ("core/src/b.rs", "g", "add", 7),
        ]);
        let rows = ["src/a.rs", "core/src/c.rs"].map(|file| row(file, "f", "add", 1, "below 8"));
        assert_eq!(found.faults(&rows, WHOLE).len(), 2);
        let without = Extent {
            has_core: false,
            ..WHOLE
        };
        assert_eq!(found.faults(&rows, without), [""; 0]);
    }

    #[test]
    fn every_row_of_the_list_has_a_bound_and_stands_once() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let rows = read(&root).unwrap();
        let keys: BTreeSet<_> = rows
            .iter()
            .map(|row| [&row.file, &row.function, &row.operation])
            .collect();
        assert_eq!(keys.len(), rows.len());
        assert!(
            rows.iter()
                .all(|row| row.bound.trim().len() > 10 && row.places > 0)
        );
    }
}
