//! Tests for 64-bit Arm: those of the vectors of NEON, in QEMU's emulation of a process, or on the
//! machine itself if it is one.

use std::{
    env,
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::Result;
use xshell::{Cmd, cmd};

use crate::{
    machine::{COMPILER_SOURCES, file_names, on_path},
    target::is_for_another_build,
    tools::{Tool, Toolbox},
    workspace::{Workspace, host_cargo},
};

/// Compiler's name of the target.
const TARGET: &str = "aarch64-unknown-linux-gnu";

/// Arguments of the tests: of the crate with the vectors. Ten million points would take minutes in
/// emulation.
const TESTS: &str = "--package fmc-camera-kernel --features resampling -- --skip ten_million";

/// Runs the tests.
///
/// # Errors
/// An error if a test fails, or if there is no compiler, linker or emulator and none can be
/// fetched.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let toolbox = Toolbox::new(workspace);
    let target = if cfg!(target_arch = "aarch64") {
        Target::Native
    } else {
        Target::emulated(workspace, &toolbox)?
    };
    let command = target.test(workspace).args(TESTS.split_whitespace());
    eprintln!("$ {command}");
    command.run()?;
    Ok(ExitCode::SUCCESS)
}

/// Way in which a test is built and run.
#[derive(Debug)]
enum Target {
    /// This machine.
    Native,
    /// Another compiler or none, a linker, and an emulator.
    Emulated {
        library: Library,
        linker: PathBuf,
        runner: PathBuf,
    },
}

/// Origin of the compiler and of its standard library for the target.
#[derive(Debug)]
enum Library {
    /// Active toolchain with its compiled library.
    Compiled,
    /// Active toolchain, the library built from its sources.
    FromSource,
    /// Distribution's compiler under the target directory, the library built from its sources.
    Fetched { rustc: PathBuf, cargo: PathBuf },
}

impl Target {
    fn emulated(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<Self> {
        let library = Library::find(workspace, toolbox)?;
        let [linker, runner] = ["aarch64-linux-gnu-gcc", "qemu-aarch64-static"];
        let (linker, runner) = if let (Some(linker), Some(runner)) =
            (on_path(linker), on_path(runner).or(on_path("qemu-aarch64")))
        {
            (linker, runner)
        } else {
            let tool = toolbox.provide(Tool::Aarch64)?;
            (tool.program(linker), tool.program(runner))
        };
        workspace.tell(&format!(
            "{TARGET}: {library:?}, linker {}, emulator {}",
            linker.display(),
            runner.display()
        ));
        Ok(Self::Emulated {
            library,
            linker,
            runner,
        })
    }

    /// Returns the command of tests with optimisation.
    fn test<'a>(&self, workspace: &'a Workspace) -> Cmd<'a> {
        let (library, linker, runner) = match self {
            Self::Native => return workspace.cargo("test --locked --release"),
            Self::Emulated {
                library,
                linker,
                runner,
            } => (library, linker, runner),
        };
        let cargo = match library {
            Library::Fetched { cargo, .. } => workspace.shell.cmd(cargo).quiet(),
            Library::Compiled | Library::FromSource => workspace.shell.cmd(host_cargo()).quiet(),
        };
        let is_fetched = matches!(library, Library::Fetched { .. });
        let names = env::vars_os().filter_map(|(name, _)| name.into_string().ok());
        let foreign = names.filter(|name| is_for_another_build(name, is_fetched));
        let mut cargo = foreign.fold(cargo, Cmd::env_remove);
        if let Library::Fetched { rustc, cargo: of } = library {
            cargo = cargo.env("RUSTC", rustc).env("CARGO", of);
        }
        if !matches!(library, Library::Compiled) {
            cargo = cargo
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_UNSTABLE_BUILD_STD", "std");
        }
        cargo
            .env(variable("LINKER"), linker)
            .env(variable("RUNNER"), runner)
            // The emulator then needs no libraries of the target.
            .env(variable("RUSTFLAGS"), "-Ctarget-feature=+crt-static")
            .args(["test", "--locked", "--release", "--target", TARGET])
            .arg("--target-dir")
            .arg(workspace.target_dir.join("aarch64"))
    }
}

impl Library {
    fn find(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<Self> {
        let shell = &workspace.shell;
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let active = PathBuf::from(cmd!(shell, "{rustc} --print sysroot").quiet().read()?);
        if has_std(&active) {
            return Ok(Self::Compiled);
        }
        if active.join(COMPILER_SOURCES).is_file() {
            return Ok(Self::FromSource);
        }
        let compiler = toolbox.provide(Tool::Compiler)?;
        Ok(Self::Fetched {
            rustc: compiler.program("rustc"),
            cargo: compiler.program("cargo"),
        })
    }
}

/// Returns true if a toolchain has a compiled standard library for the target.
fn has_std(sysroot: &Path) -> bool {
    let libraries = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    file_names(&libraries)
        .iter()
        .any(|name| name.starts_with("libstd-"))
}

/// Returns cargo's variable for a setting of the target.
fn variable(setting: &str) -> String {
    let target = TARGET.replace('-', "_").to_uppercase();
    format!("CARGO_TARGET_{target}_{setting}")
}
