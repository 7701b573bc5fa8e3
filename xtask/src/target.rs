//! The toolchain for the target, set up and ready: cargo and clippy commands that build for it.

use std::{
    env,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use xshell::{Cmd, Shell, cmd};

use crate::{
    machine::{DISTRIBUTION_BIN, Machine},
    route::{self, Need, Plan, QEMU, Route, TARGET, VECTOR_TARGET},
    workspace::{Workspace, host_cargo},
};

/// Cargo's name for the target's linker.
pub(crate) const LINKER_VARIABLE: &str = "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER";
/// And for the core with vectors.
const VECTOR_LINKER_VARIABLE: &str = "CARGO_TARGET_THUMBV8M_MAIN_NONE_EABIHF_LINKER";

/// Commands that build for the target.
#[derive(Debug)]
pub(crate) struct Target<'a> {
    shell: &'a Shell,
    route: Route,
    linker: Option<PathBuf>,
    /// Whether there is a core library for [`VECTOR_TARGET`], compiled or to compile.
    has_vector_core: bool,
    /// Apart from the host's: compilers of host and target may differ, and would discard each other's work.
    artifacts: PathBuf,
}

impl<'a> Target<'a> {
    /// Chooses the route, installs packages where it needs some, and says in one line what will be used.
    ///
    /// # Errors
    /// Where no route leads to a toolchain, or the installation fails.
    pub(crate) fn set_up(workspace: &'a Workspace, need: Need) -> Result<Self> {
        let shell = &workspace.shell;
        let mut machine = Machine::look(shell)?;
        let Plan { route, install } = route::choose(machine.facts, need)?;
        if !install.is_empty() {
            install_packages(shell, &install)?;
            machine = Machine::look(shell)?;
            let after = route::choose(machine.facts, need)?;
            ensure!(
                after.install.is_empty(),
                "still missing after installation: {}",
                after.install.join(" ")
            );
        }
        let target = Self {
            shell,
            route,
            // A compiler with a compiled core library brings its linker along.
            linker: machine.linker.filter(|_| route != Route::Active),
            has_vector_core: route != Route::Active || machine.active_has_vector_core,
            artifacts: workspace.target_dir.join("thumb"),
        };
        eprintln!("xtask: {TARGET}: {}", target.description()?);
        Ok(target)
    }

    /// Where this target's builds put programs.
    pub(crate) fn programs(&self) -> PathBuf {
        self.artifacts.join(TARGET).join("release")
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
        self.cargo_for(TARGET, line)
    }

    /// Builds a package's program of the same name for Cortex-M55 with its vectors and says where it is; says that it
    /// does not where the toolchain lacks the core library.
    ///
    /// The processor is named to the program's own crate alone, which the kernel is inlined into: the core library does not
    /// compile for it (rustc 1.96, "Do not know how to promote this operator").
    ///
    /// # Errors
    /// Where the build fails.
    pub(crate) fn build_for_vectors(&self, package: &str) -> Result<Option<PathBuf>> {
        if !self.has_vector_core {
            eprintln!(
                "note: nothing for Cortex-M55, for which `rustup target add {VECTOR_TARGET}` is needed"
            );
            return Ok(None);
        }
        let line = format!("rustc --release -p {package} --bin {package}");
        let build = self.cargo_for(VECTOR_TARGET, &line);
        let build = build.args(["--", "-Ctarget-cpu=cortex-m55"]);
        eprintln!("$ {build}");
        build.run()?;
        let programs = self.artifacts.join(VECTOR_TARGET).join("release");
        Ok(Some(programs.join(package)))
    }

    /// Cargo for one of the targets.
    fn cargo_for(&self, target: &str, line: &str) -> Cmd<'a> {
        let (subcommand, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let program = match self.route {
            Route::Active | Route::ActiveFromSource => host_cargo().into(),
            Route::Distribution => distribution_program(subcommand),
        };
        let cargo = self.in_environment(self.shell.cmd(program).quiet());
        let cargo = cargo.args([subcommand, "--locked", "--target", target, "--target-dir"]);
        cargo
            .arg(&self.artifacts)
            .args(arguments.split_whitespace())
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
        if distribution {
            let bin = Path::new(DISTRIBUTION_BIN);
            command = command
                .env("RUSTC", bin.join("rustc"))
                .env("CARGO", bin.join("cargo"));
        }
        match &self.linker {
            Some(linker) => command
                .env(LINKER_VARIABLE, linker)
                .env(VECTOR_LINKER_VARIABLE, linker),
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
fn install_packages(shell: &Shell, packages: &[&str]) -> Result<()> {
    eprintln!("xtask: installing {} by apt-get", packages.join(" "));
    let install = || -> Result<()> {
        cmd!(shell, "apt-get update --quiet").quiet().run()?;
        cmd!(
            shell,
            "apt-get install --quiet --yes --no-install-recommends --no-remove {packages...}"
        )
        .env("DEBIAN_FRONTEND", "noninteractive")
        .quiet()
        .run()?;
        Ok(())
    };
    install().with_context(|| {
        let others: Vec<_> = packages.iter().filter(|name| **name != QEMU).collect();
        if others.is_empty() {
            format!("the package cannot be installed; instead put {QEMU} on the search path")
        } else {
            format!("the packages cannot be installed; instead try: rustup target add {TARGET}")
        }
    })
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
