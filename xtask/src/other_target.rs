//! Target beside the firmware's: its cargo commands, with a compiled library of the active
//! toolchain or one that is built from its sources.

use std::{
    env,
    path::{Path, PathBuf},
};

use anyhow::Result;
use xshell::{Cmd, cmd};

use crate::{
    machine::{COMPILER_SOURCES, file_names},
    target::is_for_another_build,
    tools::{Tool, Toolbox},
    workspace::{Workspace, host_cargo},
};

/// A target with the way in which it is compiled.
#[derive(Debug)]
pub(crate) struct OtherTarget {
    /// Compiler's name of the target.
    name: &'static str,
    /// Library that is built where there is no compiled one: `std` or `core`.
    library: &'static str,
    origin: Origin,
}

/// Origin of the compiler and of its library for the target.
#[derive(Debug)]
enum Origin {
    /// Active toolchain with its compiled library.
    Compiled,
    /// Active toolchain, the library built from its sources.
    FromSource,
    /// Distribution's compiler under the target directory, the library built from its sources.
    Fetched { rustc: PathBuf, cargo: PathBuf },
}

impl OtherTarget {
    /// Finds a compiler for a target, or else fetches one.
    ///
    /// # Errors
    /// [`Missing`](crate::missing::Missing) if there is none and none can be fetched.
    pub(crate) fn find(
        workspace: &Workspace,
        toolbox: &Toolbox<'_>,
        name: &'static str,
        library: &'static str,
    ) -> Result<Self> {
        let active = active_sysroot(workspace)?;
        let origin = if has_library(&active, name) {
            Origin::Compiled
        } else if active.join(COMPILER_SOURCES).is_file() {
            Origin::FromSource
        } else {
            let compiler = toolbox.provide(Tool::Compiler)?;
            Origin::Fetched {
                rustc: compiler.program("rustc"),
                cargo: compiler.program("cargo"),
            }
        };
        Ok(Self {
            name,
            library,
            origin,
        })
    }

    /// Describes compiler and library.
    pub(crate) fn description(&self) -> String {
        let Self { name, origin, .. } = self;
        format!("{name}: {origin:?}")
    }

    /// Returns what the compiler prints as its version.
    ///
    /// # Errors
    /// An error if it does not answer.
    pub(crate) fn compiler(&self, workspace: &Workspace) -> Result<String> {
        let rustc = match &self.origin {
            Origin::Fetched { rustc, .. } => rustc.clone(),
            Origin::Compiled | Origin::FromSource => active_rustc(),
        };
        let version = self.in_environment(workspace.shell.cmd(rustc).quiet());
        Ok(version.arg("--version").read()?)
    }

    /// Returns a cargo command for the target; the words of `line` are its arguments, the
    /// subcommand first.
    pub(crate) fn cargo<'a>(&self, workspace: &'a Workspace, line: &str) -> Cmd<'a> {
        let cargo = match &self.origin {
            Origin::Fetched { cargo, .. } => workspace.shell.cmd(cargo),
            Origin::Compiled | Origin::FromSource => workspace.shell.cmd(host_cargo()),
        };
        let (subcommand, arguments) = line.split_once(' ').unwrap_or((line, ""));
        self.in_environment(cargo.quiet())
            .args([subcommand, "--locked", "--release", "--target", self.name])
            .args(arguments.split_whitespace())
    }

    /// Returns cargo's variable for a setting of the target.
    pub(crate) fn variable(&self, setting: &str) -> String {
        let target = self.name.replace('-', "_").to_uppercase();
        format!("CARGO_TARGET_{target}_{setting}")
    }

    fn in_environment<'a>(&self, command: Cmd<'a>) -> Cmd<'a> {
        let is_fetched = matches!(self.origin, Origin::Fetched { .. });
        let names = env::vars_os().filter_map(|(name, _)| name.into_string().ok());
        let foreign = names.filter(|name| is_for_another_build(name, is_fetched));
        let mut command = foreign.fold(command, Cmd::env_remove);
        if let Origin::Fetched { rustc, cargo } = &self.origin {
            command = command.env("RUSTC", rustc).env("CARGO", cargo);
        }
        if !matches!(self.origin, Origin::Compiled) {
            command = command
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_UNSTABLE_BUILD_STD", self.library);
        }
        command
    }
}

fn active_rustc() -> PathBuf {
    env::var_os("RUSTC")
        .unwrap_or_else(|| "rustc".into())
        .into()
}

/// Returns the root of the active toolchain.
///
/// # Errors
/// An error if its compiler does not answer.
pub(crate) fn active_sysroot(workspace: &Workspace) -> Result<PathBuf> {
    let rustc = active_rustc();
    let sysroot = cmd!(workspace.shell, "{rustc} --print sysroot").quiet();
    Ok(sysroot.read()?.into())
}

/// Returns true if a toolchain has a compiled standard library for the target.
fn has_library(sysroot: &Path, name: &str) -> bool {
    let libraries = sysroot.join("lib/rustlib").join(name).join("lib");
    file_names(&libraries)
        .iter()
        .any(|name| name.starts_with("libstd-"))
}
