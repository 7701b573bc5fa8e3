//! Toolchain for a target, set up and ready: cargo and clippy commands that build for it.

use std::{
    env,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};
use xshell::{Cmd, Shell};

use crate::{
    NOT_CHECKED,
    machine::{DISTRIBUTION_BIN, Machine},
    missing::Missing,
    route::{self, Architecture, Plan, Route},
    tools::{Tool, Toolbox, Unpacked},
    workspace::{Workspace, host_cargo},
};

/// Processor for the core library if it is built from its sources for Helium: one with the same
/// instruction set without vectors, because compilers up to 1.96 fail on the half-precision numbers
/// of the library if they may use Helium's.
const PROCESSOR_OF_CORE: &str = "cortex-m33";

/// Need of clippy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lints {
    Wanted,
    NotWanted,
}

/// Targets of this workspace.
#[derive(Debug)]
pub(crate) struct Targets<'a> {
    /// Cortex-M4F and M7.
    pub(crate) armv7em: Target<'a>,
    /// Cortex-M55, if a toolchain builds for it.
    pub(crate) helium: Option<Target<'a>>,
}

impl<'a> Targets<'a> {
    /// Sets up the firmware's target, and Helium's if no further tool has to be fetched for it.
    ///
    /// # Errors
    /// As [`Target::set_up`].
    pub(crate) fn set_up(
        workspace: &'a Workspace,
        toolbox: &Toolbox<'_>,
        lints: Lints,
    ) -> Result<Self> {
        let armv7em = Target::set_up(workspace, toolbox, lints)?;
        let helium = Target::without_fetching(workspace, toolbox, Architecture::Helium)?
            .inspect_err(|lack| {
                eprintln!("{NOT_CHECKED}Cortex-M55, for which nothing is built or counted: {lack}");
            })
            .ok();
        Ok(Self { armv7em, helium })
    }

    /// Returns the target of an architecture, if there is one.
    pub(crate) fn of(&self, architecture: Architecture) -> Option<&Target<'a>> {
        match architecture {
            Architecture::Armv7em => Some(&self.armv7em),
            Architecture::Helium => self.helium.as_ref(),
            Architecture::Armv7emSoft | Architecture::Armv8m => None,
        }
    }
}

/// Commands that build for one target.
#[derive(Clone, Debug)]
pub(crate) struct Target<'a> {
    shell: &'a Shell,
    architecture: Architecture,
    route: Route,
    programs: Programs,
    linker: Option<PathBuf>,
    /// Reason for having no lints for the target.
    no_clippy: Option<Missing>,
    /// Directory separate from the host's: compilers of host and target may differ, and would
    /// discard each other's artifacts.
    artifacts: PathBuf,
    /// `true` if every operation is checked for overflow.
    checks_overflow: bool,
}

/// Programs of a route.
#[derive(Clone, Debug)]
struct Programs {
    rustc: PathBuf,
    cargo: PathBuf,
    /// Clippy, called directly: cargo would look for it among the user's own programs first, and
    /// find another compiler's. The active toolchain's clippy is called by its cargo.
    cargo_clippy: Option<PathBuf>,
}

impl Programs {
    fn of(route: Route, toolbox: &Toolbox<'_>) -> Self {
        let clippy = |tool: Unpacked| tool.program("cargo-clippy");
        let fetched_clippy = || toolbox.find(Tool::Clippy).map(clippy);
        let bin = Path::new(DISTRIBUTION_BIN);
        match route {
            Route::Active | Route::ActiveFromSource => Self {
                rustc: env::var_os("RUSTC")
                    .unwrap_or_else(|| "rustc".into())
                    .into(),
                cargo: host_cargo().into(),
                cargo_clippy: None,
            },
            Route::Installed => Self {
                rustc: bin.join("rustc"),
                cargo: bin.join("cargo"),
                cargo_clippy: Some(bin.join("cargo-clippy"))
                    .filter(|program| program.is_file())
                    .or_else(fetched_clippy),
            },
            Route::Fetched => {
                let compiler = toolbox.place(Tool::Compiler);
                Self {
                    rustc: compiler.program("rustc"),
                    cargo: compiler.program("cargo"),
                    cargo_clippy: fetched_clippy(),
                }
            }
        }
    }
}

impl<'a> Target<'a> {
    /// Sets up the firmware's target: chooses the route, fetches what it needs, and prints in one
    /// line what will be used.
    ///
    /// # Errors
    /// [`Missing`] if there is no compiler or no linker and none can be fetched.
    pub(crate) fn set_up(
        workspace: &'a Workspace,
        toolbox: &Toolbox<'_>,
        lints: Lints,
    ) -> Result<Self> {
        let architecture = Architecture::Armv7em;
        let machine = Machine::look(&workspace.shell, toolbox, architecture)?;
        let plan = route::plan(machine.facts);
        let mut no_clippy = (!plan.has_clippy).then(|| Missing::clippy(toolbox.system()));
        for tool in &plan.fetch {
            match (tool, lints) {
                // Builds do not need the lints, so a missing clippy is not an error here.
                (Tool::Clippy, Lints::Wanted) => no_clippy = toolbox.provide(*tool).err(),
                (Tool::Clippy, Lints::NotWanted) => {}
                _ => drop(toolbox.provide(*tool)?),
            }
        }
        let machine = Machine::look(&workspace.shell, toolbox, architecture)?;
        let target = Self {
            no_clippy,
            ..Self::new(workspace, toolbox, architecture, &plan, machine)
        };
        workspace.tell(&target.description()?);
        Ok(target)
    }

    /// Sets up a further target if no tool has to be fetched for it, and prints in one line what
    /// will be used; returns what is missing otherwise.
    ///
    /// # Errors
    /// An error if the compiler does not answer.
    pub(crate) fn without_fetching(
        workspace: &'a Workspace,
        toolbox: &Toolbox<'_>,
        architecture: Architecture,
    ) -> Result<Result<Self, String>> {
        let machine = Machine::look(&workspace.shell, toolbox, architecture)?;
        let plan = route::plan(machine.facts);
        let lack = plan.fetch.iter().find(|tool| **tool != Tool::Clippy);
        if let Some(tool) = lack {
            let target = architecture.target();
            return Ok(Err(format!(
                "no {tool}; to mend it: rustup target add {target}"
            )));
        }
        let target = Self::new(workspace, toolbox, architecture, &plan, machine);
        workspace.tell(&target.description()?);
        Ok(Ok(target))
    }

    /// Creates the commands of a plan on a machine.
    fn new(
        workspace: &'a Workspace,
        toolbox: &Toolbox<'_>,
        architecture: Architecture,
        plan: &Plan,
        machine: Machine,
    ) -> Self {
        let route = plan.route;
        Self {
            shell: &workspace.shell,
            architecture,
            route,
            programs: Programs::of(route, toolbox),
            // A compiler with a compiled core library includes a linker.
            linker: machine.linker.filter(|_| route != Route::Active),
            no_clippy: None,
            artifacts: workspace.target_dir.join("thumb"),
            checks_overflow: false,
        }
    }

    /// Returns commands that build with checks of every operation for overflow, in a directory of
    /// their own. Failed checks stay apart, each with its place.
    pub(crate) fn checking_overflow(&self) -> Self {
        Self {
            artifacts: self.artifacts.with_extension("overflow"),
            checks_overflow: true,
            ..self.clone()
        }
    }

    /// Returns true if the core library is built with the program.
    pub(crate) fn builds_core(&self) -> bool {
        self.route != Route::Active
    }

    /// Returns the reason for having no lints for the target, if there are none.
    pub(crate) fn no_clippy(&self) -> Option<&Missing> {
        self.no_clippy.as_ref()
    }

    /// Returns the directory of the programs that this target's builds produce.
    pub(crate) fn programs(&self) -> PathBuf {
        self.made_with("release")
    }

    /// Returns the directory of what this target's builds produce with a profile.
    pub(crate) fn made_with(&self, profile: &str) -> PathBuf {
        let target = self.artifacts.join(self.architecture.target());
        target.join(profile)
    }

    /// Returns name and number of the compiler.
    ///
    /// # Errors
    /// An error if it does not answer.
    pub(crate) fn compiler(&self) -> Result<String> {
        let version = self.compiler_version()?;
        let words: Vec<_> = version.split_whitespace().take(2).collect();
        Ok(words.join(" "))
    }

    /// Returns what the compiler prints as its version.
    fn compiler_version(&self) -> Result<String> {
        let rustc = self.shell.cmd(&self.programs.rustc).quiet();
        let version = self.in_environment(rustc).arg("--version");
        version.read().map_err(Into::into)
    }

    /// Returns a cargo command for the target; the words of `line` are its arguments, the
    /// subcommand first.
    pub(crate) fn cargo(&self, line: &str) -> Cmd<'a> {
        let (subcommand, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let clippy = self.programs.cargo_clippy.as_ref();
        let program = clippy.filter(|_| subcommand == "clippy");
        let program = program.unwrap_or(&self.programs.cargo);
        let cargo = self.in_environment(self.shell.cmd(program).quiet());
        let target = self.architecture.target();
        let cargo = cargo.args([subcommand, "--locked", "--target", target, "--target-dir"]);
        cargo
            .arg(&self.artifacts)
            .args(self.settings())
            .args(arguments.split_whitespace())
    }

    /// Returns cargo's settings that compile for the processor, except for the core library that is
    /// built with it.
    fn settings(&self) -> Vec<String> {
        if self.checks_overflow {
            return ["--config", "profile.release.overflow-checks=true"]
                .map(str::to_owned)
                .into();
        }
        let processor = self.architecture.processor();
        let Some(processor) = processor.filter(|_| self.route != Route::Active) else {
            return vec![];
        };
        [
            (
                "profile.release.rustflags",
                format!("-Ctarget-cpu={processor}"),
            ),
            (
                "profile.release.package.core.rustflags",
                format!("-Ctarget-cpu={PROCESSOR_OF_CORE}"),
            ),
            // Build scripts would otherwise get the profile's flags, with a processor that is not
            // that of this machine.
            (
                "profile.release.build-override.rustflags",
                "-Copt-level=0".to_owned(),
            ),
        ]
        .into_iter()
        .flat_map(|(key, flag)| ["--config".to_owned(), format!("{key}=[\"{flag}\"]")])
        .collect()
    }

    /// Returns the command with the variables of this route and without those that belong to other
    /// builds.
    fn in_environment(&self, command: Cmd<'a>) -> Cmd<'a> {
        let distribution = matches!(self.route, Route::Installed | Route::Fetched);
        let names = env::vars_os().filter_map(|(name, _)| name.into_string().ok());
        let foreign = names.filter(|name| is_for_another_build(name, distribution));
        let mut command = foreign.fold(command, Cmd::env_remove);
        if self.route != Route::Active {
            command = command
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_UNSTABLE_BUILD_STD", "core");
        }
        if let Some(processor) = self.architecture.processor() {
            command = if self.route == Route::Active {
                let flags = self.architecture.variable("RUSTFLAGS");
                command.env(flags, format!("-Ctarget-cpu={processor}"))
            } else {
                // `settings` needs this variable.
                command.env("CARGO_UNSTABLE_PROFILE_RUSTFLAGS", "true")
            };
        }
        if self.checks_overflow {
            // Otherwise calls with different places become one.
            let flags = self.architecture.variable("RUSTFLAGS");
            command = command.env(flags, "-Cllvm-args=-enable-tail-merge=0");
        }
        if distribution {
            command = command
                .env("RUSTC", &self.programs.rustc)
                .env("CARGO", &self.programs.cargo);
        }
        match &self.linker {
            Some(linker) => command.env(self.architecture.variable("LINKER"), linker),
            None => command,
        }
    }

    /// Describes the target, its compiler, the origin of its core library, and the linker.
    fn description(&self) -> Result<String> {
        let target = self.architecture.target();
        let rustc = self.compiler_version().context(target)?;
        let origin = match self.route {
            Route::Active => "the active toolchain, which has the target",
            Route::ActiveFromSource => "the active toolchain, core built from its sources",
            Route::Installed => "the distribution, core built from its sources",
            Route::Fetched => "the distribution, under target/tools, core built from its sources",
        };
        let linker = self
            .linker
            .as_deref()
            .map(|path| format!(", linker {}", path.display()));
        Ok(format!(
            "{target}: {rustc} of {origin}{}",
            linker.unwrap_or_default()
        ))
    }
}

/// Returns true for variables that belong to builds for the host, or, for a compiler of the
/// distribution, to those of the toolchain that started xtask.
pub(crate) fn is_for_another_build(name: &str, distribution: bool) -> bool {
    is_for_host(name) || (distribution && is_for_active_toolchain(name))
}

/// Returns true for flags and targets that the user set for host builds.
fn is_for_host(name: &str) -> bool {
    [
        "RUSTFLAGS",
        "CARGO_ENCODED_RUSTFLAGS",
        "CARGO_BUILD_RUSTFLAGS",
        "CARGO_BUILD_TARGET",
    ]
    .contains(&name)
}

/// Returns true for variables that the toolchain that started xtask set in the environment for its
/// own programs.
fn is_for_active_toolchain(name: &str) -> bool {
    name == "CARGO"
        || name == "LD_LIBRARY_PATH"
        || [
            "CARGO_PKG_",
            "CARGO_MANIFEST_",
            "CARGO_BUILD_RUSTC",
            "RUSTC",
            "RUSTUP_",
        ]
        .iter()
        .any(|prefix| name.starts_with(prefix))
}

#[cfg(test)]
mod tests {
    use super::{is_for_active_toolchain, is_for_host};

    #[test]
    fn distribution_keeps_what_users_set_for_cargo_and_drops_what_names_another_compiler() {
        for (name, dropped) in [
            ("CARGO", true),
            ("CARGO_PKG_NAME", true),
            ("CARGO_MANIFEST_DIR", true),
            ("CARGO_ENCODED_RUSTFLAGS", true),
            ("LD_LIBRARY_PATH", true),
            ("RUSTC", true),
            ("RUSTC_WRAPPER", true),
            ("RUSTFLAGS", true),
            ("RUSTUP_TOOLCHAIN", true),
            ("CARGO_HOME", false),
            ("CARGO_BUILD_JOBS", false),
            ("CARGO_HTTP_PROXY", false),
            ("CARGO_NET_OFFLINE", false),
            ("CARGO_TERM_COLOR", false),
            ("PATH", false),
            ("RUST_BACKTRACE", false),
        ] {
            assert_eq!(
                is_for_active_toolchain(name) || is_for_host(name),
                dropped,
                "{name}"
            );
        }
    }
}
