//! Python with packages under `<target>/tools`: the machine's interpreter, or the distribution's
//! packages unpacked there.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail, ensure};
use xshell::{Cmd, Shell, cmd};

use crate::{
    machine::on_path,
    tools::{Tool, Toolbox},
    version::Version,
    workspace::Workspace,
};

/// Oldest version: it reads TOML.
const OLDEST: Version = Version::new(3, 11);

/// Name of the program.
const PROGRAM: &str = "python3";

/// File that names the packages of a directory that is complete.
const COMPLETE: &str = "packages";

/// An interpreter with packages.
#[derive(Debug)]
pub(crate) struct Python {
    program: PathBuf,
    /// Directories of modules.
    modules: Vec<PathBuf>,
    /// Directories of shared libraries.
    libraries: Vec<PathBuf>,
}

impl Python {
    /// Finds or fetches an interpreter, and the packages for it, which are kept in a directory of
    /// that name.
    ///
    /// # Errors
    /// An error that says what is not available.
    pub(crate) fn with(
        workspace: &Workspace,
        toolbox: &Toolbox<'_>,
        name: &str,
        packages: &[&str],
    ) -> Result<Self> {
        let shell = &workspace.shell;
        let mut python = Self::find(shell, toolbox)?;
        let version = stated_version(shell, &python.program)
            .or_else(|_| succeed(python.run(shell).arg("--version")))?;
        workspace.tell(&format!(
            "{} of {}",
            version.trim(),
            python.program.display()
        ));
        let tools = workspace.target_dir.join("tools");
        let place = tools.join(name);
        // Packages with compiled code are of one version of Python.
        let wanted = format!("{}\n{}", version.trim(), packages.join("\n"));
        let is_complete = |place: &Path| {
            fs::read_to_string(place.join(COMPLETE)).is_ok_and(|found| found == wanted)
        };
        if !is_complete(&place) {
            let _lock = Workspace::lock(&tools, "fetches tools")?;
            if !is_complete(&place) {
                python.fetch(shell, &place, packages, &wanted)?;
            }
        }
        python.modules = vec![place];
        Ok(python)
    }

    /// Returns the command that runs the interpreter.
    pub(crate) fn run<'a>(&self, shell: &'a Shell) -> Cmd<'a> {
        let Self { program, .. } = self;
        let mut command = cmd!(shell, "{program}").env_remove("PYTHONHOME");
        for (variable, directories) in [
            ("PYTHONPATH", &self.modules),
            ("LD_LIBRARY_PATH", &self.libraries),
        ] {
            if let Ok(value) = env::join_paths(directories)
                && !directories.is_empty()
            {
                command = command.env(variable, value);
            }
        }
        command
    }

    /// Finds an interpreter with pip on the search path, or else fetches what it lacks.
    fn find(shell: &Shell, toolbox: &Toolbox<'_>) -> Result<Self> {
        let on_path = on_path(PROGRAM).filter(|program| {
            let version = stated_version(shell, program);
            version.is_ok_and(|text| Version::find(&text) >= Some(OLDEST))
        });
        if let Some(program) = &on_path {
            let python = Self {
                program: program.clone(),
                modules: Vec::new(),
                libraries: Vec::new(),
            };
            if succeed(python.run(shell).args(["-m", "pip", "--version"])).is_ok() {
                return Ok(python);
            }
        }
        let root = toolbox.provide(Tool::Pip)?.root();
        let fetched = root.join("usr/bin").join(PROGRAM);
        let libraries = match &on_path {
            Some(_) => Vec::new(),
            None => library_directories(&root),
        };
        let program = match on_path {
            Some(program) => program,
            None if fetched.is_file() => fetched,
            None => bail!("no {PROGRAM} of {OLDEST} or later on the search path"),
        };
        Ok(Self {
            program,
            modules: vec![root.join("usr/lib/python3/dist-packages")],
            libraries,
        })
    }

    /// Fetches packages into a directory, which is complete or absent.
    fn fetch(&self, shell: &Shell, place: &Path, packages: &[&str], complete: &str) -> Result<()> {
        eprintln!(
            "xtask: fetching {} into {}",
            packages.join(", "),
            place.display()
        );
        let new = place.with_extension("new");
        for directory in [&new, place] {
            if directory.exists() {
                fs::remove_dir_all(directory).with_context(|| directory.display().to_string())?;
            }
        }
        let install = self
            .run(shell)
            .args([
                "-m",
                "pip",
                "install",
                "--quiet",
                "--no-input",
                "--no-cache-dir",
            ])
            .args([
                "--disable-pip-version-check",
                "--only-binary",
                ":all:",
                "--target",
            ])
            .arg(&new)
            .args(packages);
        succeed(install).context("pip")?;
        ensure!(new.is_dir(), "pip has installed nothing");
        fs::write(new.join(COMPLETE), complete).with_context(|| new.display().to_string())?;
        fs::rename(&new, place).with_context(|| place.display().to_string())
    }
}

/// Returns the directories of shared libraries of an unpacked system.
fn library_directories(root: &Path) -> Vec<PathBuf> {
    ["usr/lib", "lib"]
        .into_iter()
        .flat_map(|parent| {
            let entries = fs::read_dir(root.join(parent)).into_iter().flatten();
            entries.filter_map(|entry| Some(entry.ok()?.path()))
        })
        .filter(|path| path.to_string_lossy().contains("-linux-gnu"))
        .collect()
}

/// Returns the error of a command with what it has printed.
fn succeed(command: Cmd<'_>) -> Result<String> {
    let output = command.quiet().ignore_status().output()?;
    let errors = String::from_utf8_lossy(&output.stderr);
    let last = errors.lines().rfind(|line| !line.trim().is_empty());
    ensure!(
        output.status.success(),
        "{}",
        last.unwrap_or("it says nothing").trim()
    );
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Returns the version that a Python states.
fn stated_version(shell: &Shell, program: &Path) -> Result<String> {
    succeed(cmd!(shell, "{program} --version"))
}
