//! Blocks of code in the documents: what runs each kind.

use std::{fs, path::Path};

use clap::Parser as _;

use super::source::Source;
use crate::Arguments;

/// Document, kind of its blocks, and the test that runs them or compares them with what is printed.
const RUN: [(&str, &str, &str); 13] = [
    ("README.md", "rust", "src/lib.rs"),
    ("README.md", "csv", "host-sim/tests/command_line/verify.rs"),
    ("docs/integration.md", "rust", "src/lib.rs"),
    ("docs/c.md", "c", "bindings/c/tests/c_library/guide.rs"),
    (
        "docs/python.md",
        "python",
        "bindings/python/tests/test_guide.py",
    ),
    (
        "docs/python-session.md",
        "python",
        "bindings/python/tests/test_session.py",
    ),
    (
        "docs/python-session.md",
        "output",
        "bindings/python/tests/test_session.py",
    ),
    (
        "docs/start.md",
        "text",
        "host-sim/tests/command_line/start.rs",
    ),
    (
        "docs/start.md",
        "output",
        "host-sim/tests/command_line/start.rs",
    ),
    (
        "docs/start.md",
        "python",
        "bindings/python/tests/test_session.py",
    ),
    (
        "docs/start.md",
        "output",
        "bindings/python/tests/test_session.py",
    ),
    (
        "docs/camera-file.md",
        "toml",
        "host-sim/tests/command_line/documents.rs",
    ),
    (
        "docs/integration.md",
        "output",
        "tests/conventions/integration/mod.rs",
    ),
];

/// Files of settings, which are read and not run: the profile of a firmware's `Cargo.toml`, and
/// settings of a flight.
const READ: [(&str, &str); 1] = [("docs/integration.md", "toml")];

/// Programs whose commands the documents show. Those of `host-sim` are checked by
/// `host-sim/tests/command_line/documents.rs`, those of xtask below.
const PROGRAMS: [&str; 7] = [
    "host-sim ",
    "target/release/host-sim ",
    "cargo ",
    "pip install ",
    "python3 -m pip install ",
    "arm-none-eabi-gcc ",
    "west build ",
];

/// Returns kind, number of the first line, and text of the fenced blocks of a document.
fn fenced(document: &str) -> Vec<(String, usize, String)> {
    let mut found = Vec::new();
    let mut open: Option<(String, usize, String)> = None;
    for (number, line) in (1..).zip(document.lines()) {
        match (line.strip_prefix("```"), &mut open) {
            (Some(kind), None) => open = Some((kind.to_owned(), number, String::new())),
            (Some(_), Some(_)) => found.extend(open.take()),
            (None, Some((_, _, text))) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    // A block that is never closed ends with the document.
    found.extend(open);
    found
}

/// Returns what is wrong with the blocks of a document: kinds of which it is not known what runs
/// them.
fn unknown(file: &str, document: &str) -> Vec<String> {
    let is_known = |kind: &str, text: &str| {
        let first = text.lines().next().unwrap_or_default();
        match kind {
            "text" => PROGRAMS.iter().any(|program| first.starts_with(program)),
            kind => {
                let mut rows = RUN.iter();
                rows.any(|row| (row.0, row.1) == (file, kind)) || READ.contains(&(file, kind))
            }
        }
    };
    fenced(document)
        .into_iter()
        .filter(|(kind, _, text)| !is_known(kind, text))
        .map(|(kind, line, _)| format!("{file}, line {line}: what runs a block of kind {kind:?}"))
        .collect()
}

/// Returns the commands of xtask in the blocks of a document, by their arguments.
fn commands(document: &str) -> Vec<Vec<&str>> {
    document
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("cargo xtask "))
        .map(|line| line.split('#').next().unwrap_or_default())
        .map(|line| line.split_whitespace().collect())
        .collect()
}

fn is_taken(command: &[&str]) -> bool {
    Arguments::try_parse_from(["xtask"].iter().chain(command)).is_ok()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

#[test]
fn every_block_is_run_by_a_test_that_names_its_document_or_is_a_command() {
    let source = Source::collect(root()).unwrap();
    let mut blocks = 0;
    for (page, text) in &source.pages {
        let file = page.display().to_string();
        // Not those of sources, which are no documents.
        let is_document = root().join(page).is_file();
        if is_document && (file == "README.md" || file.starts_with("docs/")) {
            assert_eq!(unknown(&file, text), Vec::<String>::new());
            blocks += fenced(text).len();
        }
    }
    assert!(blocks > 40, "{blocks}");
    let rows = RUN.map(|(file, kind, _)| (file, kind));
    for (file, kind) in rows.into_iter().chain(READ) {
        let document = fs::read_to_string(root().join(file)).unwrap();
        let mut blocks = fenced(&document).into_iter();
        assert!(blocks.any(|block| block.0 == kind), "{file} has no {kind}");
    }
    for (file, kind, test) in RUN {
        let text = fs::read_to_string(root().join(test)).unwrap();
        assert!(text.contains(file), "{test} does not name {file} ({kind})");
    }
}

#[test]
fn block_that_nothing_runs_is_found() {
    let found = unknown(
        "docs/c.md",
        "a\n```c\nint x;\n```\n```ada\nx\n```\n```text\nx = y\n```\n```open\nx\n",
    );
    let lines = ["line 5", "line 8", "line 11"].map(|line| format!("docs/c.md, {line}:"));
    assert_eq!(found.len(), lines.len(), "{found:?}");
    for (fault, line) in found.iter().zip(lines) {
        assert!(fault.starts_with(&line), "{fault}");
    }
}

#[test]
fn every_command_of_xtask_in_the_documents_is_one() {
    let source = Source::collect(root()).unwrap();
    let mut count = 0;
    for text in source.pages.values() {
        for command in commands(text) {
            assert!(is_taken(&command), "cargo xtask {}", command.join(" "));
            count += 1;
        }
    }
    assert!(count > 8, "{count}");
    assert!(!is_taken(&["firmwares"]));
}
