//! The library's test programs, with every mutant in them.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail, ensure};
use serde::Deserialize;

use super::{edits, mutant::Mutant, schema};
use crate::{checks::FEATURES_OF_TESTS, workspace::Workspace};

/// Programs as cargo has built them.
#[derive(Debug)]
pub(super) struct Programs {
    pub(super) paths: Vec<PathBuf>,
    /// Numbers of the mutants that are no program: the compiler refuses them.
    pub(super) refused: BTreeSet<usize>,
    /// Numbers of those that cannot be put beside the others.
    pub(super) without_place: BTreeSet<usize>,
}

/// Writes the sources with the mutants into `tree`, and builds the programs of the tests.
///
/// # Errors
/// An error if files cannot be written or read, or if the program cannot be built without mutants.
pub(super) fn build(workspace: &Workspace, tree: &Path, mutants: &[Mutant]) -> Result<Programs> {
    link(&workspace.root, tree)?;
    let mut refused = BTreeSet::new();
    loop {
        let without_place = write(&workspace.root, tree, mutants, &refused)?;
        let errors = match compile(workspace, tree, CHECK)? {
            Compiled::Errors(errors) => errors,
            Compiled::Programs(_) => match compile(workspace, tree, BUILD)? {
                Compiled::Errors(errors) => errors,
                Compiled::Programs(paths) => {
                    ensure!(!paths.is_empty(), "cargo has built no test program");
                    return Ok(Programs {
                        paths,
                        refused,
                        without_place,
                    });
                }
            },
        };
        let before = refused.len();
        for error in &errors {
            let path = tree.join(&error.file);
            let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            refused.extend(edits::numbers_at(&text, error.byte));
        }
        if refused.len() == before {
            let texts: Vec<_> = errors.iter().map(|error| error.rendered.as_str()).collect();
            bail!("the program does not compile:\n{}", texts.join("\n"));
        }
        workspace.tell(&format!("{} mutants are no program", refused.len()));
    }
}

/// Arguments of cargo that find the mutants which are no program, and those that build.
const CHECK: &str = "check --lib";
const BUILD: &str = "test --no-run --lib --test library";

/// Links what is beside the sources into the tree.
fn link(root: &Path, tree: &Path) -> Result<()> {
    fs::create_dir_all(tree).with_context(|| tree.display().to_string())?;
    for entry in fs::read_dir(root).with_context(|| root.display().to_string())? {
        let entry = entry?;
        let name = entry.file_name();
        let link = tree.join(&name);
        if name == "src" || name == "target" || link.symlink_metadata().is_ok() {
            continue;
        }
        link_one(&entry.path(), &link)?;
    }
    Ok(())
}

#[cfg(unix)]
fn link_one(original: &Path, link: &Path) -> Result<()> {
    std::os::unix::fs::symlink(original, link).with_context(|| link.display().to_string())
}

#[cfg(not(unix))]
fn link_one(_: &Path, _: &Path) -> Result<()> {
    bail!("mutants can be tried on Linux alone")
}

/// Writes the sources; returns the numbers of the mutants that have no place.
fn write(
    root: &Path,
    tree: &Path,
    mutants: &[Mutant],
    refused: &BTreeSet<usize>,
) -> Result<BTreeSet<usize>> {
    let mut by_file: BTreeMap<&str, Vec<(usize, &Mutant)>> = BTreeMap::new();
    for (number, mutant) in mutants.iter().enumerate() {
        if !refused.contains(&number) {
            by_file
                .entry(&mutant.file)
                .or_default()
                .push((number, mutant));
        }
    }
    let mut without_place = BTreeSet::new();
    let mut sources = vec![];
    files(&root.join("src"), &mut sources)?;
    for source in sources {
        let name = source.strip_prefix(root).unwrap_or(&source);
        let mut text = fs::read_to_string(&source).with_context(|| source.display().to_string())?;
        if let Some(mutants) = by_file.get(&*name.display().to_string()) {
            let schema = schema::write(&text, mutants);
            let schema = schema.with_context(|| name.display().to_string())?;
            without_place.extend(schema.without_place);
            text = schema.text;
        }
        if name == Path::new("src/lib.rs") {
            text = with_switch(&text)?;
        }
        write_if_other(&tree.join(name), &text)?;
    }
    write_if_other(&tree.join("src/mutant.rs"), &switch(mutants.len()))?;
    Ok(without_place)
}

/// Returns the source of the module that knows which of so many mutants the program is.
fn switch(count: usize) -> String {
    include_str!("switch.rs").replace("COUNT", &count.to_string())
}

/// Adds the module that knows which mutant the program is.
fn with_switch(text: &str) -> Result<String> {
    const FORBIDDEN: &str = "#![forbid(unsafe_code)]";
    const MODULE: &str = "pub mod flight;";
    const STD: &str = "#[cfg(test)]\nextern crate std;";
    for part in [FORBIDDEN, MODULE, STD] {
        ensure!(text.contains(part), "src/lib.rs has no {part}");
    }
    Ok(text
        .replace(
            FORBIDDEN,
            "#![allow(internal_features)]\n#![feature(core_intrinsics, const_eval_select)]",
        )
        .replace(STD, "extern crate std;")
        .replace(
            MODULE,
            "#[allow(missing_docs)]\npub mod mutant;\npub mod flight;",
        ))
}

/// Writes a file unless it is so already, so that cargo compiles what is new.
fn write_if_other(path: &Path, text: &str) -> Result<()> {
    let told = || path.display().to_string();
    if fs::read_to_string(path).is_ok_and(|before| before == text) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(told)?;
    }
    fs::write(path, text).with_context(told)
}

/// Collects the files of a folder and of those in it.
pub(super) fn files(folder: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            files(&path, found)?;
        } else {
            found.push(path);
        }
    }
    Ok(())
}

/// Outcome of a build.
enum Compiled {
    Programs(Vec<PathBuf>),
    Errors(Vec<CompileError>),
}

/// Place at which the compiler finds an error.
struct CompileError {
    file: String,
    byte: usize,
    rendered: String,
}

/// Line that cargo writes.
#[derive(Debug, Deserialize)]
struct Line {
    reason: String,
    executable: Option<PathBuf>,
    message: Option<Message>,
}

#[derive(Debug, Deserialize)]
struct Message {
    level: String,
    rendered: Option<String>,
    spans: Vec<MessageSpan>,
}

#[derive(Debug, Deserialize)]
struct MessageSpan {
    file_name: String,
    byte_start: usize,
    is_primary: bool,
}

fn compile(workspace: &Workspace, tree: &Path, line: &str) -> Result<Compiled> {
    let _directory = workspace.shell.push_dir(tree);
    let output = workspace
        .cargo(line)
        .args(["--quiet", "--locked", "--package", "fmc-camera"])
        .args(["--message-format", "json", "--features"])
        .arg(FEATURES_OF_TESTS)
        .arg("--target-dir")
        .arg(tree.with_file_name("build"))
        // Functions that ask for the mutant are evaluated by the compiler, too.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTFLAGS", "--cap-lints warn -A warnings")
        .ignore_status()
        .output()?;
    let mut programs = vec![];
    let mut errors = vec![];
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Ok(line) = serde_json::from_str::<Line>(line) else {
            continue;
        };
        if line.reason == "compiler-artifact" {
            programs.extend(line.executable);
        }
        let Some(message) = line.message.filter(|message| message.level == "error") else {
            continue;
        };
        for span in message.spans.iter().filter(|span| span.is_primary) {
            errors.push(CompileError {
                file: span.file_name.clone(),
                byte: span.byte_start,
                rendered: message.rendered.clone().unwrap_or_default(),
            });
        }
    }
    if output.status.success() {
        return Ok(Compiled::Programs(programs));
    }
    ensure!(
        !errors.is_empty(),
        "cargo: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(Compiled::Errors(errors))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::process::Command;

    use super::*;
    use crate::mutants::decisions;

    /// A program that prints whether a decision with two conditions holds, by a function that is
    /// evaluated by the compiler, too.
    const SPECIMEN: &str = "extern crate std;
const fn holds(a: bool, b: bool) -> bool { a && b }
const _: () = assert!(!holds(true, false));
fn main() { std::print!(\"{} {}\", holds(true, false), holds(false, true)); }
mod mutant {}
";

    #[test]
    fn specimen_is_each_of_its_mutants_and_records_those_that_it_reaches() {
        let folder = std::env::temp_dir().join(format!("fmc-specimen-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let mutants = decisions::conditions("specimen.rs", SPECIMEN).unwrap();
        let changes: Vec<_> = mutants
            .iter()
            .map(|mutant| mutant.change.as_str())
            .collect();
        assert_eq!(changes.len(), 4);
        let numbered: Vec<_> = mutants.iter().enumerate().collect();
        let text = schema::write(SPECIMEN, &numbered).unwrap().text;
        let switch = switch(5).replace("//!", "//");
        let text = format!(
            "#![allow(internal_features)]\n#![feature(core_intrinsics, const_eval_select)]\n{}",
            text.replace("mod mutant {}", &format!("mod mutant {{{switch}}}"))
        );
        let [source, program, record] =
            ["specimen.rs", "specimen", "record"].map(|name| folder.join(name));
        fs::write(&source, text).unwrap();
        let mut compiler = Command::new("rustc");
        compiler
            .args(["--edition", "2024", "-A", "warnings", "-o"])
            .arg(&program)
            .arg(&source);
        assert!(
            compiler
                .env("RUSTC_BOOTSTRAP", "1")
                .status()
                .unwrap()
                .success()
        );
        let output = |number: Option<&str>| {
            let mut run = Command::new(&program);
            if let Some(number) = number {
                run.env("FMC_MUTANT", number);
            }
            let output = run.env("FMC_MUTANTS_REACHED", &record).output().unwrap();
            String::from_utf8(output.stdout).unwrap()
        };
        for (number, change, expected) in [
            (None, "", "false false"),
            (Some("0"), "condition a with true", "false true"),
            (Some("1"), "condition a with false", "false false"),
            (Some("2"), "condition b with true", "true false"),
            (Some("3"), "condition b with false", "false false"),
            (Some("record"), "", "false false"),
        ] {
            assert_eq!(output(number), expected, "{number:?}");
            if let Some(change_of) =
                number.and_then(|number| changes.get(number.parse::<usize>().ok()?))
            {
                assert!(change_of.contains(change), "{change_of}");
            }
        }
        // The fifth is nowhere.
        assert_eq!(fs::read(&record).unwrap(), [1, 1, 1, 1, 0]);
        fs::remove_dir_all(&folder).unwrap();
    }
}
