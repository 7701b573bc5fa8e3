//! The project's own `unsafe`: each file that has any is in a list, with a reason and a test.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail, ensure};
use clap::ValueEnum as _;
use proc_macro2::{TokenStream, TokenTree};
use serde::Deserialize;

use crate::checks::Step;

/// The list.
const LIST: &str = "docs/unsafe.csv";

/// Folders with sources of Rust, from the root.
const FOLDERS: [&str; 9] = [
    "benches", "bindings", "crates", "examples", "fuzz", "host-sim", "src", "tests", "xtask",
];

/// A row of the list.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    file: String,
    /// Number of times that the file has the word.
    count: usize,
    reason: String,
    /// Name of a test, or `step` and a step of `cargo xtask test`, that runs the code.
    test: String,
}

/// Checks the list against the sources.
///
/// # Errors
/// An error that names every file that is not in the list as it is, or whose test does not exist.
pub(super) fn check(root: &Path) -> Result<()> {
    let sources = Sources::read(root)?;
    let faults = faults(&rows(&root.join(LIST))?, &sources);
    if !faults.is_empty() {
        bail!("unsafe code of this project:\n{}", faults.join("\n"));
    }
    let (files, places) = (sources.counts.len(), sources.counts.values().sum::<usize>());
    eprintln!("unsafe code of this project: {places} places in {files} files, all listed");
    Ok(())
}

fn rows(list: &Path) -> Result<Vec<Row>> {
    let mut reader = csv::Reader::from_path(list).with_context(|| list.display().to_string())?;
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.with_context(|| list.display().to_string())
}

/// Sources of the project.
#[derive(Debug, Default)]
struct Sources {
    /// Number of times that each file has `unsafe`; files without it are left out.
    counts: BTreeMap<String, usize>,
    /// Texts of all files, in which tests are found.
    texts: Vec<String>,
}

impl Sources {
    fn read(root: &Path) -> Result<Self> {
        let mut sources = Self::default();
        for folder in FOLDERS {
            sources.add(root, &root.join(folder))?;
        }
        ensure!(!sources.counts.is_empty(), "no source has unsafe code");
        Ok(sources)
    }

    fn add(&mut self, root: &Path, folder: &Path) -> Result<()> {
        let told = || folder.display().to_string();
        for entry in fs::read_dir(folder).with_context(told)? {
            let path = entry.with_context(told)?.path();
            if path.is_dir() {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                if name != "target" && !name.starts_with('.') {
                    self.add(root, &path)?;
                }
                continue;
            }
            let end = path.extension().and_then(|end| end.to_str());
            if !matches!(end, Some("rs" | "py")) {
                continue;
            }
            let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            if end == Some("rs") {
                let tokens: TokenStream = text
                    .parse()
                    .map_err(|error| anyhow::anyhow!("{}: {error}", path.display()))?;
                let count = count(tokens);
                if count > 0 {
                    self.counts.insert(name(root, &path), count);
                }
            }
            self.texts.push(text);
        }
        Ok(())
    }

    /// Returns whether a test, or a step, of that name exists.
    fn has_test(&self, test: &str) -> bool {
        if let Some(step) = test.strip_prefix("step ") {
            return Step::value_variants().iter().any(|one| one.name() == step);
        }
        let [rust, python] = [format!("fn {test}("), format!("def {test}(")];
        self.texts.iter().any(|text| {
            let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
            lines.iter().enumerate().any(|(index, line)| {
                let before = lines.get(..index).unwrap_or_default().iter().rev();
                let mut attributes = before.take_while(|line| line.starts_with("#["));
                let is_rust = line.starts_with(&rust) && attributes.any(|one| *one == "#[test]");
                is_rust || (test.starts_with("test_") && line.starts_with(&python))
            })
        })
    }
}

fn name(root: &Path, path: &Path) -> String {
    let parts: PathBuf = path.strip_prefix(root).unwrap_or(path).into();
    let parts = parts.iter().map(|part| part.to_string_lossy());
    parts.collect::<Vec<_>>().join("/")
}

/// Returns how often code has the word, comments and texts left out.
fn count(tokens: TokenStream) -> usize {
    let counts = tokens.into_iter().map(|token| match token {
        TokenTree::Group(group) => count(group.stream()),
        TokenTree::Ident(word) => usize::from(word == "unsafe"),
        _ => 0,
    });
    counts.sum()
}

fn faults(rows: &[Row], sources: &Sources) -> Vec<String> {
    let mut found = Vec::new();
    let mut unlisted = sources.counts.clone();
    for row in rows {
        let file = &row.file;
        match unlisted.remove(file) {
            Some(count) if count == row.count => {}
            Some(count) => found.push(format!(
                "{file}: {LIST} states {}, the file has {count}",
                row.count
            )),
            None => found.push(format!("{file}: {LIST} has it twice, or in vain")),
        }
        if row.reason.trim().is_empty() {
            found.push(format!("{file}: {LIST} has no reason"));
        }
        if !sources.has_test(&row.test) {
            found.push(format!(
                "{file}: {LIST} names {:?}, which is not a test",
                row.test
            ));
        }
    }
    found.extend(
        unlisted
            .into_iter()
            .map(|(file, count)| format!("{file}: {count} times unsafe, and not in {LIST}")),
    );
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(text: &str) -> usize {
        count(text.parse().unwrap())
    }

    #[test]
    fn word_is_counted_in_code_alone() {
        assert_eq!(
            counted("#![forbid(unsafe_code)] /// unsafe\nfn f() { \"unsafe\" }"),
            0
        );
        assert_eq!(
            counted("#[unsafe(no_mangle)] unsafe fn f() { unsafe { g() } }"),
            3
        );
    }

    #[test]
    fn unlisted_changed_and_untested_code_is_found() {
        let row = |file: &str, count, reason: &str, test: &str| Row {
            file: file.to_owned(),
            count,
            reason: reason.to_owned(),
            test: test.to_owned(),
        };
        let sources = Sources {
            counts: [("a.rs", 2), ("b.rs", 1)]
                .map(|(file, count)| (file.to_owned(), count))
                .into(),
            texts: vec![
                "    #[test]\n    fn tested() {}\nfn helper() {}".to_owned(),
                "    def test_also(self):".to_owned(),
            ],
        };
        let whole = [
            row("a.rs", 2, "registers", "tested"),
            row("b.rs", 1, "a name", "step c"),
        ];
        assert!(sources.has_test("test_also") && !sources.has_test("helper"));
        assert_eq!(faults(&whole, &sources), [""; 0]);
        let wrong = [
            row("a.rs", 3, " ", "test"),
            row("c.rs", 1, "registers", "test_also"),
        ];
        let found = faults(&wrong, &sources);
        assert_eq!(found.len(), 5, "{found:#?}");
    }
}
