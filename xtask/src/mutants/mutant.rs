//! Mutants of the library: each is one small change that the tests should notice.

use std::fmt;

use anyhow::{Context as _, Result};
use serde::Deserialize;

use crate::{crate_program::CrateProgram, workspace::Workspace};

const CARGO_MUTANTS: CrateProgram = CrateProgram {
    name: "cargo-mutants",
    version: "27.1.0",
    before_version: "cargo-mutants ",
    options: "",
};

/// Place in a source: line and column of a character, both from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub(super) struct Place {
    pub(super) line: usize,
    pub(super) column: usize,
}

/// Part of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub(super) struct Span {
    pub(super) start: Place,
    pub(super) end: Place,
}

/// Kinds of changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub(super) enum Genre {
    /// The function returns a constant.
    FnValue,
    /// Another operator stands between two operands.
    BinaryOperator,
    /// An operator before an operand is left out.
    UnaryOperator,
    /// An arm of a `match` is left out.
    MatchArm,
    /// The guard of an arm is constant.
    MatchArmGuard,
    /// A field of a struct has the value of the base.
    StructField,
    /// One condition of several of a decision is constant.
    Condition,
}

/// A change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Mutant {
    /// Path from the root.
    pub(super) file: String,
    pub(super) genre: Genre,
    /// Text that is replaced.
    pub(super) span: Span,
    pub(super) replacement: String,
    /// The function and the change in words.
    pub(super) change: String,
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { line, column } = self.span.start;
        write!(f, "{}:{line}:{column}: {}", self.file, self.change)
    }
}

/// Mutants that `cargo-mutants` finds.
#[derive(Debug)]
pub(super) struct Listed {
    pub(super) mutants: Vec<Mutant>,
    /// Number of those in constants, which no switch at run time changes.
    pub(super) in_constants: usize,
}

/// Mutant as `cargo-mutants` lists it.
#[derive(Debug, Deserialize)]
struct Item {
    file: String,
    function: Option<serde_json::Value>,
    genre: Genre,
    span: Span,
    replacement: String,
    name: String,
}

/// Returns the mutants of files.
///
/// # Errors
/// An error if `cargo-mutants` cannot be had or says something else than a list.
pub(super) fn list(workspace: &Workspace, files: &[String]) -> Result<Listed> {
    let program = CARGO_MUTANTS.find(workspace)?;
    let _directory = workspace.shell.push_dir(&workspace.root);
    let files = files.iter().flat_map(|file| ["--file", file]);
    let command = workspace
        .shell
        .cmd(program)
        .args(["mutants", "--list", "--json", "--package", "fmc-camera"])
        .args(files);
    let text = command.quiet().read()?;
    let items: Vec<Item> = serde_json::from_str(&text).context("list of cargo-mutants")?;
    let all = items.len();
    let mutants: Vec<_> = items
        .into_iter()
        .filter(|item| item.function.is_some())
        .map(|item| {
            // It begins with the place.
            let change = item.name.splitn(2, ": ").last().unwrap_or_default();
            Mutant {
                change: change.to_owned(),
                file: item.file,
                genre: item.genre,
                span: item.span,
                replacement: item.replacement,
            }
        })
        .collect();
    let in_constants = all - mutants.len();
    Ok(Listed {
        mutants,
        in_constants,
    })
}
