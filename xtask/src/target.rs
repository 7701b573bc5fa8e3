//! The toolchain for a target, set up and ready: cargo and clippy commands that build for it.

use std::{
    env,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use xshell::{Cmd, Shell, cmd};

use crate::{
    machine::{DISTRIBUTION_BIN, Machine},
    route::{self, Architecture, Need, Plan, QEMU, Route},
    workspace::{Workspace, host_cargo},
};

/// Processor for the core library where it is built from its sources for Helium: of the same instruction set without
/// vectors, because compilers up to 1.96 fail on the half-precision numbers of the library when they may use Helium's.
const PROCESSOR_OF_CORE: &str = "cortex-m33";

/// The targets of this workspace.
#[derive(Debug)]
pub(crate) struct Targets<'a> {
    /// Cortex-M4F and M7.
    pub(crate) armv7em: Target<'a>,
    /// Cortex-M55, where a toolchain builds for it.
    pub(crate) helium: Option<Target<'a>>,
    /// Whether what else is wanted may be installed.
    pub(crate) may_install: bool,
}

impl<'a> Targets<'a> {
    /// Sets up the firmware's target, and Helium's as far as that needs no installation of its own.
    ///
    /// # Errors
    /// As [`Target::set_up`].
    pub(crate) fn set_up(workspace: &'a Workspace, need: Need) -> Result<Self> {
        let armv7em = Target::set_up(workspace, need)?;
        let machine = Machine::look(&workspace.shell, Architecture::Helium)?;
        let may_install = machine.facts.may_install;
        let helium = match route::choose_without_installing(Architecture::Helium, machine.facts) {
            Ok(route) => Some(Target::new(
                workspace,
                Architecture::Helium,
                route,
                machine,
            )?),
            Err(no_route) => {
                eprintln!("note: nothing is built or counted for Cortex-M55: {no_route}");
                None
            }
        };
        Ok(Self {
            armv7em,
            helium,
            may_install,
        })
    }

    /// The one of an architecture, where there is one.
    pub(crate) fn of(&self, architecture: Architecture) -> Option<&Target<'a>> {
        match architecture {
            Architecture::Armv7em => Some(&self.armv7em),
            Architecture::Helium => self.helium.as_ref(),
        }
    }
}

/// Commands that build for one target.
#[derive(Debug)]
pub(crate) struct Target<'a> {
    shell: &'a Shell,
    architecture: Architecture,
    route: Route,
    linker: Option<PathBuf>,
    /// Apart from the host's: compilers of host and target may differ, and would discard each other's work.
    artifacts: PathBuf,
}

impl<'a> Target<'a> {
    /// The firmware's target: chooses the route, installs packages where it needs some, and says in one line what will
    /// be used.
    ///
    /// # Errors
    /// Where no route leads to a toolchain, or the installation fails.
    pub(crate) fn set_up(workspace: &'a Workspace, need: Need) -> Result<Self> {
        let shell = &workspace.shell;
        let architecture = Architecture::Armv7em;
        let mut machine = Machine::look(shell, architecture)?;
        let Plan { route, install } = route::choose(architecture, machine.facts, need)?;
        if !install.is_empty() {
            install_packages(shell, &install).with_context(|| way_out(&install))?;
            machine = Machine::look(shell, architecture)?;
            let after = route::choose(architecture, machine.facts, need)?;
            ensure!(
                after.install.is_empty(),
                "still missing after installation: {}",
                after.install.join(" ")
            );
        }
        Self::new(workspace, architecture, route, machine)
    }

    /// Commands of that route on that machine.
    fn new(
        workspace: &'a Workspace,
        architecture: Architecture,
        route: Route,
        machine: Machine,
    ) -> Result<Self> {
        let target = Self {
            shell: &workspace.shell,
            architecture,
            route,
            // A compiler with a compiled core library brings its linker along.
            linker: machine.linker.filter(|_| route != Route::Active),
            artifacts: workspace.target_dir.join("thumb"),
        };
        eprintln!(
            "xtask: {}: {}",
            architecture.target(),
            target.description()?
        );
        Ok(target)
    }

    /// Where this target's builds put programs.
    pub(crate) fn programs(&self) -> PathBuf {
        let target = self.artifacts.join(self.architecture.target());
        target.join("release")
    }

    /// The compiler's name and number.
    ///
    /// # Errors
    /// Where it does not answer.
    pub(crate) fn compiler(&self) -> Result<String> {
        let version = self.compiler_version()?;
        let words: Vec<_> = version.split_whitespace().take(2).collect();
        Ok(words.join(" "))
    }

    /// What the compiler says of itself.
    fn compiler_version(&self) -> Result<String> {
        let rustc = match self.route {
            Route::Active | Route::ActiveFromSource => env::var_os("RUSTC")
                .unwrap_or_else(|| "rustc".into())
                .into(),
            Route::Distribution => Path::new(DISTRIBUTION_BIN).join("rustc"),
        };
        let version = self
            .in_environment(self.shell.cmd(rustc).quiet())
            .arg("--version");
        version.read().map_err(Into::into)
    }

    /// Cargo for the target, with the words of `line` as arguments, the subcommand first.
    pub(crate) fn cargo(&self, line: &str) -> Cmd<'a> {
        let (subcommand, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let program = match self.route {
            Route::Active | Route::ActiveFromSource => host_cargo().into(),
            Route::Distribution => distribution_program(subcommand),
        };
        let cargo = self.in_environment(self.shell.cmd(program).quiet());
        let target = self.architecture.target();
        let cargo = cargo.args([subcommand, "--locked", "--target", target, "--target-dir"]);
        cargo
            .arg(&self.artifacts)
            .args(self.settings())
            .args(arguments.split_whitespace())
    }

    /// Settings of cargo by which the processor is compiled for, but not the core library that is built with it.
    fn settings(&self) -> Vec<String> {
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
            // Build scripts would get the profile's, which name no processor of this machine's.
            (
                "profile.release.build-override.rustflags",
                "-Copt-level=0".to_owned(),
            ),
        ]
        .into_iter()
        .flat_map(|(key, flag)| ["--config".to_owned(), format!("{key}=[\"{flag}\"]")])
        .collect()
    }

    /// The command with the variables of this route and without those that belong to other builds.
    fn in_environment(&self, command: Cmd<'a>) -> Cmd<'a> {
        let distribution = self.route == Route::Distribution;
        let is_foreign =
            |name: &String| is_for_host(name) || (distribution && is_for_active_toolchain(name));
        let names = env::vars_os().filter_map(|(name, _)| name.into_string().ok());
        let mut command = names.filter(is_foreign).fold(command, Cmd::env_remove);
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
                // For `settings`.
                command.env("CARGO_UNSTABLE_PROFILE_RUSTFLAGS", "true")
            };
        }
        if distribution {
            let bin = Path::new(DISTRIBUTION_BIN);
            command = command
                .env("RUSTC", bin.join("rustc"))
                .env("CARGO", bin.join("cargo"));
        }
        match &self.linker {
            Some(linker) => command.env(self.architecture.variable("LINKER"), linker),
            None => command,
        }
    }

    /// Compiler, origin of its core library, and linker.
    fn description(&self) -> Result<String> {
        let rustc = self.compiler_version()?;
        let origin = match self.route {
            Route::Active => "the active toolchain, which has the target",
            Route::ActiveFromSource => "the active toolchain, core built from its sources",
            Route::Distribution => "the distribution, core built from its sources",
        };
        let linker = self
            .linker
            .as_deref()
            .map(|path| format!(", linker {}", path.display()));
        Ok(format!("{rustc} of {origin}{}", linker.unwrap_or_default()))
    }
}

/// The distribution's program for a subcommand. Clippy's is called directly, because cargo would look for it
/// among the user's own programs first and find another compiler's.
fn distribution_program(subcommand: &str) -> PathBuf {
    let program = if subcommand == "clippy" {
        "cargo-clippy"
    } else {
        "cargo"
    };
    Path::new(DISTRIBUTION_BIN).join(program)
}

/// Flags and targets that the user set for host builds.
fn is_for_host(name: &str) -> bool {
    [
        "RUSTFLAGS",
        "CARGO_ENCODED_RUSTFLAGS",
        "CARGO_BUILD_RUSTFLAGS",
        "CARGO_BUILD_TARGET",
    ]
    .contains(&name)
}

/// What the toolchain that started xtask has left in the environment for its own programs.
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

/// Installs packages by apt-get; nothing that is installed is removed for them.
///
/// # Errors
/// Where apt-get fails.
pub(crate) fn install_packages(shell: &Shell, packages: &[&str]) -> Result<()> {
    eprintln!("xtask: installing {} by apt-get", packages.join(" "));
    cmd!(shell, "apt-get update --quiet").quiet().run()?;
    cmd!(
        shell,
        "apt-get install --quiet --yes --no-install-recommends --no-remove {packages...}"
    )
    .env("DEBIAN_FRONTEND", "noninteractive")
    .quiet()
    .run()?;
    Ok(())
}

/// What else leads to a target where its packages cannot be installed.
fn way_out(packages: &[&str]) -> String {
    let others: Vec<_> = packages.iter().filter(|name| **name != QEMU).collect();
    if others.is_empty() {
        format!("the package cannot be installed; instead put {QEMU} on the search path")
    } else {
        let target = Architecture::Armv7em.target();
        format!("the packages cannot be installed; instead try: rustup target add {target}")
    }
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
