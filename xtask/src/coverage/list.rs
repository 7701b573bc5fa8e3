//! List of the lines and branches that the library's own tests do not reach, with the reasons.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use anyhow::{Context as _, Result};
use lcov::report::section::{Value as Section, branch};
use serde::Deserialize;

use crate::source;

/// The list.
pub(super) const LIST: &str = "docs/coverage.csv";

/// Row of the list.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    file: String,
    function: String,
    /// Number of lines of the function that are not reached.
    lines: usize,
    /// Number of branches of the function that are not taken.
    branches: usize,
    /// Reason that no test of the library can reach them.
    reason: String,
}

pub(super) fn read(root: &Path) -> Result<Vec<Row>> {
    let list = root.join(LIST);
    let mut reader = csv::Reader::from_path(&list).with_context(|| list.display().to_string())?;
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.with_context(|| list.display().to_string())
}

/// Lines and branches of a function that are not reached.
#[derive(Debug, Default)]
struct Gap {
    lines: BTreeSet<u32>,
    branches: BTreeSet<branch::Key>,
}

/// Measurement of all files.
#[derive(Debug, Default)]
pub(super) struct Found {
    gaps: BTreeMap<[String; 2], Gap>,
    code: BTreeMap<String, Vec<String>>,
    /// Lines and branches, and how many of them are reached.
    pub(super) lines: [usize; 2],
    pub(super) branches: [usize; 2],
}

impl Found {
    /// Adds a file with its code. The tests at its end are not measured.
    pub(super) fn add(&mut self, name: &str, code: Vec<String>, measured: &Section) {
        let end = code.iter().zip(code.iter().skip(1));
        let end = end.zip(1_u32..).find_map(|((first, second), number)| {
            (first == "#[cfg(test)]" && second.starts_with("mod ")).then_some(number)
        });
        let is_measured = |line: u32| end.is_none_or(|end| line < end);
        let key = |line: u32| {
            let function = source::function(&code, line).unwrap_or_default();
            [name.to_owned(), function]
        };
        for (at, reached) in &measured.lines {
            if is_measured(at.line) {
                self.lines[0] += 1;
                if reached.count > 0 {
                    self.lines[1] += 1;
                } else {
                    let gap = self.gaps.entry(key(at.line)).or_default();
                    gap.lines.insert(at.line);
                }
            }
        }
        for (at, reached) in &measured.branches {
            if is_measured(at.line) {
                self.branches[0] += 1;
                // A condition that was never looked at has no number.
                if reached.taken.is_some_and(|taken| taken > 0) {
                    self.branches[1] += 1;
                } else {
                    self.gaps
                        .entry(key(at.line))
                        .or_default()
                        .branches
                        .insert(*at);
                }
            }
        }
        self.code.insert(name.to_owned(), code);
    }

    /// Returns how the list differs from what was found.
    pub(super) fn faults(&self, rows: &[Row]) -> Vec<String> {
        let mut faults = vec![];
        let mut listed = BTreeMap::new();
        for row in rows {
            let name = format!("{}, {}", row.file, row.function);
            if row.reason.trim().is_empty() {
                faults.push(format!("{name}: {LIST} has no reason"));
            }
            let key = [row.file.clone(), row.function.clone()];
            if listed.insert(key, [row.lines, row.branches]).is_some() {
                faults.push(format!("{name}: {LIST} has it twice"));
            }
        }
        for (key, gap) in &self.gaps {
            let [file, function] = key;
            let found = [gap.lines.len(), gap.branches.len()];
            let stated = listed.remove(key).unwrap_or_default();
            if found != stated {
                let [lines, branches] = found;
                faults.push(format!(
                    "{file}, {function}: {lines} lines and {branches} branches are not reached, \
                    {LIST} has {} and {}:{}",
                    stated[0],
                    stated[1],
                    self.places(file, gap)
                ));
            }
        }
        faults.extend(listed.keys().map(|[file, function]| {
            format!("{file}, {function}: all of it is reached, though {LIST} has it")
        }));
        faults
    }

    fn places(&self, file: &str, gap: &Gap) -> String {
        let code = |line: u32| {
            let index = usize::try_from(line)
                .ok()
                .and_then(|line| line.checked_sub(1));
            let code = index.and_then(|index| self.code.get(file)?.get(index));
            code.map_or("", |code| code.trim())
        };
        let lines = gap
            .lines
            .iter()
            .map(|line| format!("\n    {line}: {}", code(*line)));
        let branches = gap.branches.iter().map(|at| {
            let (line, condition) = (at.line, at.block + 1);
            let which = if at.branch % 2 == 0 { "true" } else { "false" };
            format!(
                "\n    {line}: condition {condition} never {which}: {}",
                code(line)
            )
        });
        lines.chain(branches).collect()
    }
}

#[cfg(test)]
mod tests {
    use lcov::{Reader, Report};

    use super::*;

    const CODE: &str = "
fn first(a: bool) -> u8 {
    if a {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    fn helper() {}
}
";

    /// Returns what a report of `first` says, one line of it to a word.
    fn found(report: &str) -> Found {
        let mut found = Found::default();
        let lines = report.replace(' ', "\n");
        let text = format!("TN:\nSF:a.rs\n{lines}\nend_of_record\n");
        let report = Report::from_reader(Reader::new(text.as_bytes())).unwrap();
        let file = report.sections.into_values().next().unwrap();
        let code = CODE.lines().map(str::to_owned).collect();
        found.add("src/flight/a.rs", code, &file);
        found
    }

    fn row(lines: usize, branches: usize, reason: &str) -> Row {
        Row {
            file: "src/flight/a.rs".to_owned(),
            function: "first".to_owned(),
            lines,
            branches,
            reason: reason.to_owned(),
        }
    }

    #[test]
    fn what_is_not_reached_is_compared_with_the_list_in_both_directions() {
        let gaps = found("DA:3,4 DA:4,4 DA:6,0 DA:12,0 BRDA:3,0,0,4 BRDA:3,0,1,0");
        assert_eq!((gaps.lines, gaps.branches), ([3, 2], [2, 1]));
        assert_eq!(gaps.faults(&[row(1, 1, "not on a PC")]), [""; 0]);
        let [fault] = &gaps.faults(&[])[..] else {
            panic!("one fault");
        };
        for part in ["6: 2", "3: condition 1 never false: if a {", "has 0 and 0"] {
            assert!(fault.contains(part), "{fault}");
        }
        assert_eq!(gaps.faults(&[row(1, 0, "not on a PC")]).len(), 1);
        assert_eq!(gaps.faults(&[row(1, 1, " ")]).len(), 1);
        let twice = [row(1, 1, "not on a PC"), row(1, 1, "not on a PC")];
        assert_eq!(gaps.faults(&twice).len(), 1);
        let all = found("DA:3,4 DA:6,1");
        let [fault] = &all.faults(&[row(1, 1, "not on a PC")])[..] else {
            panic!("one fault");
        };
        assert!(fault.contains("all of it is reached"), "{fault}");
    }
}
