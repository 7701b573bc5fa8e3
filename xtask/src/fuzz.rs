//! `cargo xtask fuzz`: the targets of fuzz under libFuzzer.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Context as _, Result, bail};
use xshell::Cmd;

use crate::{CHECK_FAILED, NOT_STARTED, crate_program::CrateProgram, workspace::Workspace};

#[path = "../../fuzz/corpus.rs"]
mod corpus;

const CARGO_FUZZ: CrateProgram = CrateProgram {
    name: "cargo-fuzz",
    version: "0.13.2",
    before_version: "cargo-fuzz ",
    options: "",
};

/// Folders of the project, besides the corpus, whose files are input of a target.
const ALSO_INPUT: [(&str, &[&str]); 2] = [
    (
        "camera_file",
        &["host-sim/cameras", "host-sim/scenarios/cameras"],
    ),
    (
        "scenario",
        &["host-sim/scenarios", "host-sim/scenarios/faults"],
    ),
];

/// Options of a run.
#[derive(Debug)]
pub(crate) struct Fuzzing {
    /// Time for each target, s.
    pub(crate) seconds: u32,
    /// True if new input goes into the corpus.
    pub(crate) keep: bool,
}

impl Fuzzing {
    /// Runs targets, all if none is named.
    ///
    /// # Errors
    /// An error for a name that is not a target, for a damaged corpus, or if folders
    /// cannot be read or written.
    pub(crate) fn run(&self, workspace: &Workspace, named: &[String]) -> Result<ExitCode> {
        let fuzz = workspace.root.join("fuzz");
        let all = targets(&fuzz)?;
        if let Some(unknown) = named.iter().find(|name| !all.contains(*name)) {
            let all: Vec<_> = all.into_iter().collect();
            bail!("{unknown} is not a target; there are {}", all.join(", "));
        }
        check_corpora(&fuzz, &all)?;
        let program = match CARGO_FUZZ.find(workspace) {
            Ok(program) => program,
            Err(error) => {
                eprintln!("xtask: no target was run: {error:#}");
                return Ok(ExitCode::from(NOT_STARTED));
            }
        };
        let target_dir = workspace.target_dir.join("fuzz");
        let mut failed = Vec::new();
        let chosen = all
            .iter()
            .filter(|name| named.is_empty() || named.contains(name));
        for name in chosen {
            let place = Place {
                fuzz: &fuzz,
                target_dir: &target_dir,
                name,
            };
            if !self.fuzz(workspace, &program, &place)? {
                failed.push(name.as_str());
            }
        }
        if failed.is_empty() {
            return Ok(ExitCode::SUCCESS);
        }
        eprintln!("xtask: failed: {}", failed.join(", "));
        Ok(ExitCode::from(CHECK_FAILED))
    }

    /// Runs a target; returns whether no input failed.
    fn fuzz(&self, workspace: &Workspace, program: &Path, place: &Place<'_>) -> Result<bool> {
        let found = place.found();
        let artifacts = place.target_dir.join("artifacts").join(place.name);
        for folder in [&found, &artifacts, &place.corpus()] {
            fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
        workspace.tell(&format!("{} for {} s", place.name, self.seconds));
        // A trailing separator makes it a folder.
        let prefix = artifacts.join("");
        let run = place
            .command(workspace, program, "run")
            .arg(&found)
            .args(place.inputs(&workspace.root))
            .arg("--")
            .arg(format!("-max_total_time={}", self.seconds))
            .arg(format!("-artifact_prefix={}", prefix.display()))
            .args([
                "-seed=1",
                "-print_final_stats=1",
                "-timeout=20",
                "-rss_limit_mb=2048",
            ]);
        let passed = run.run().is_ok();
        if passed && self.keep {
            place
                .command(workspace, program, "run")
                .arg(place.corpus())
                .arg(&found)
                .args(["--", "-merge=1"])
                .run()?;
        }
        Ok(passed)
    }
}

/// Reads the corpora of the targets; returns the number of their inputs.
///
/// # Errors
/// An error that names a folder or a file that cannot be read, or is empty.
fn check_corpora(fuzz: &Path, targets: &BTreeSet<String>) -> Result<usize> {
    let mut inputs = 0;
    for name in targets {
        let folder = fuzz.join("corpus").join(name);
        // Files that people have written are read instead of a corpus, until one is kept.
        if ALSO_INPUT.iter().any(|(also, _)| also == name) && !folder.exists() {
            continue;
        }
        inputs += corpus::read(&folder).map_err(anyhow::Error::msg)?.len();
    }
    Ok(inputs)
}

/// Folders of a target.
#[derive(Debug)]
struct Place<'a> {
    fuzz: &'a Path,
    target_dir: &'a Path,
    name: &'a str,
}

impl Place<'_> {
    fn corpus(&self) -> PathBuf {
        self.fuzz.join("corpus").join(self.name)
    }

    fn found(&self) -> PathBuf {
        self.target_dir.join("found").join(self.name)
    }

    fn inputs(&self, root: &Path) -> Vec<PathBuf> {
        let also = ALSO_INPUT.iter().find(|(name, _)| *name == self.name);
        let also = also.map_or(&[][..], |(_, folders)| *folders).iter();
        also.map(|folder| root.join(folder))
            .chain([self.corpus()])
            .collect()
    }

    /// Returns cargo-fuzz's command without a sanitizer of memory: all code is safe Rust, and the
    /// compiler need not be a nightly one.
    fn command<'a>(&self, workspace: &'a Workspace, program: &Path, command: &str) -> Cmd<'a> {
        let fuzz = workspace.shell.cmd(program).quiet();
        fuzz.arg("fuzz")
            .arg(command)
            .args(["--sanitizer", "none", "--fuzz-dir"])
            .arg(self.fuzz)
            .arg("--target-dir")
            .arg(self.target_dir)
            .arg(self.name)
    }
}

/// Returns the names of the targets.
fn targets(fuzz: &Path) -> Result<BTreeSet<String>> {
    let folder = fuzz.join("fuzz_targets");
    let told = || folder.display().to_string();
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(&folder).with_context(told)? {
        let path = entry.with_context(told)?.path();
        names.extend(
            path.file_stem()
                .map(|name| name.to_string_lossy().into_owned()),
        );
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn damaged_corpus_is_named() {
        let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
        let targets = targets(&fuzz).unwrap();
        assert!(check_corpora(&fuzz, &targets).unwrap() > 250);

        let root = std::env::temp_dir().join(format!("damaged-corpus-{}", std::process::id()));
        let corpus = root.join("corpus/wire");
        let wire = BTreeSet::from(["wire".to_owned()]);
        let error = || check_corpora(&root, &wire).unwrap_err().to_string();
        let missing = error();
        fs::create_dir_all(&corpus).unwrap();
        let without_input = error();
        fs::write(corpus.join("whole"), [1]).unwrap();
        assert_eq!(check_corpora(&root, &wire).unwrap(), 1);
        fs::write(corpus.join("cut-off"), []).unwrap();
        let empty = error();
        fs::write(corpus.join("cut-off"), vec![0; 70_000]).unwrap();
        let long = error();
        fs::remove_file(corpus.join("cut-off")).unwrap();
        fs::create_dir(corpus.join("a-folder")).unwrap();
        let no_file = error();
        fs::remove_dir_all(&root).unwrap();
        for (error, names) in [
            (&missing, "wire: "),
            (&without_input, "wire: no input"),
            (&empty, "cut-off: empty"),
            (&long, "cut-off: longer than 64 KiB"),
            (&no_file, "a-folder: not a file"),
        ] {
            assert!(
                error.starts_with("corpus ") && error.contains(names),
                "{error}"
            );
        }
    }

    #[test]
    fn folders_of_input_are_those_of_targets_and_have_files() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let fuzz = root.join("fuzz");
        let targets = targets(&fuzz).unwrap();
        assert!(ALSO_INPUT.iter().all(|(name, _)| targets.contains(*name)));
        for name in &targets {
            let target_dir = root.join("target");
            let place = Place {
                fuzz: &fuzz,
                target_dir: &target_dir,
                name,
            };
            let inputs = place.inputs(&root).into_iter().filter(|path| path.exists());
            let files = inputs.flat_map(|folder| fs::read_dir(folder).unwrap());
            assert!(files.count() > 2, "{name}");
        }
    }
}
