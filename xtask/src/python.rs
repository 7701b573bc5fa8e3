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
#[derive(Clone, Debug)]
pub(crate) struct Python {
    program: PathBuf,
    /// Directories with the installer of packages, where it is not the interpreter's own.
    installer: Vec<PathBuf>,
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
        python.installer = std::mem::take(&mut python.modules);
        python.and(workspace, name, packages)
    }

    /// Fetches further packages into a directory of a name of its own, unless they are there.
    ///
    /// # Errors
    /// An error that says what is not available.
    pub(crate) fn and(
        mut self,
        workspace: &Workspace,
        name: &str,
        packages: &[&str],
    ) -> Result<Self> {
        let place = self.provide(workspace, name, packages)?;
        self.modules.insert(0, place);
        Ok(self)
    }

    /// Adds a directory of modules, before the others.
    pub(crate) fn with_modules(mut self, directory: PathBuf) -> Self {
        self.modules.insert(0, directory);
        self
    }

    /// Returns the path of a program that a package has brought.
    ///
    /// # Errors
    /// An error if no directory of packages has it.
    pub(crate) fn brought(&self, name: &str) -> Result<PathBuf> {
        let name = format!("{name}{}", env::consts::EXE_SUFFIX);
        let mut places = self.modules.iter().flat_map(|place| {
            ["bin", "Scripts"].map(|directory| place.join(directory).join(&name))
        });
        let found = places.find(|path| path.is_file());
        found.with_context(|| format!("the packages have no program {name}"))
    }

    /// Fetches packages into a directory, unless they are there, and returns it.
    fn provide(&self, workspace: &Workspace, name: &str, packages: &[&str]) -> Result<PathBuf> {
        let shell = &workspace.shell;
        let python = Self {
            program: self.program.clone(),
            installer: Vec::new(),
            modules: self.installer.clone(),
            libraries: self.libraries.clone(),
        };
        let version = stated_version(shell, &python.program)
            .or_else(|_| succeed(python.run(shell).arg("--version")))?;
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
        Ok(place)
    }

    /// Returns the command that runs the interpreter.
    pub(crate) fn run<'a>(&self, shell: &'a Shell) -> Cmd<'a> {
        self.program(shell, &self.program)
    }

    /// Returns the command that runs a program which the packages have brought.
    pub(crate) fn program<'a>(&self, shell: &'a Shell, program: &Path) -> Cmd<'a> {
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
                installer: Vec::new(),
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
            installer: Vec::new(),
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
pub(crate) fn succeed(command: Cmd<'_>) -> Result<String> {
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
