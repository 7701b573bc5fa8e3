//! Facts about this machine that matter for building for a target: toolchains, linkers, programs on
//! the search path.

use std::{
    env::{self, consts::EXE_SUFFIX},
    fs,
    path::{Path, PathBuf},
};

use anyhow::Result;
use xshell::{Shell, cmd};

use crate::{
    route::{Architecture, Facts, Toolchain},
    tools::{Tool, Toolbox},
    version::Version,
    workspace::host_cargo,
};

/// Directory in which Debian and Ubuntu install a compiler; on other systems it holds none.
pub(crate) const DISTRIBUTION_BIN: &str = "/usr/bin";

/// File that library sources contain, below a compiler's root.
pub(crate) const COMPILER_SOURCES: &str = "lib/rustlib/src/rust/library/core/Cargo.toml";

/// Facts for [`crate::route::plan`], and further data that carrying out the plan needs.
#[derive(Debug)]
pub(crate) struct Machine {
    /// Facts on which the decision is based.
    pub(crate) facts: Facts,
    /// A linker that knows the target.
    pub(crate) linker: Option<PathBuf>,
}

impl Machine {
    /// Examines the machine and the tools that have been fetched; it changes nothing.
    ///
    /// # Errors
    /// An error if the active compiler does not answer.
    pub(crate) fn look(
        shell: &Shell,
        toolbox: &Toolbox<'_>,
        architecture: Architecture,
    ) -> Result<Self> {
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let active = PathBuf::from(cmd!(shell, "{rustc} --print sysroot").quiet().read()?);
        let cargo = host_cargo();
        let active_has_clippy = cmd!(shell, "{cargo} clippy --version")
            .quiet()
            .ignore_stderr()
            .read()
            .is_ok();
        let installed = installed_sysroot(shell);
        let fetched = toolbox.find(Tool::Compiler);

        let bin = Path::new(DISTRIBUTION_BIN);
        let installed_has_clippy =
            bin.join("cargo-clippy").is_file() && bin.join("clippy-driver").is_file();
        let fetched_has_clippy = toolbox.find(Tool::Clippy).is_some();
        let offers = |sysroot: &Path, clippy| Toolchain {
            target_core: has_core(sysroot, architecture),
            library_sources: sysroot.join(COMPILER_SOURCES).is_file(),
            clippy,
        };
        let linker = find_linker(architecture, [Some(active.as_path()), installed.as_deref()])
            .or_else(|| Some(toolbox.find(Tool::Linker)?.program("ld.lld")));
        Ok(Self {
            facts: Facts {
                active: offers(&active, active_has_clippy),
                installed: installed
                    .as_deref()
                    .map_or_else(Toolchain::default, |sysroot| {
                        offers(sysroot, installed_has_clippy || fetched_has_clippy)
                    }),
                fetched: fetched.map_or_else(Toolchain::default, |compiler| {
                    offers(&compiler.root().join("usr"), fetched_has_clippy)
                }),
                linker: linker.is_some(),
            },
            linker,
        })
    }
}

/// Returns the root of the distribution's installed toolchain, if there is one with a cargo that is
/// new enough for this workspace.
fn installed_sysroot(shell: &Shell) -> Option<PathBuf> {
    let bin = Path::new(DISTRIBUTION_BIN);
    let rustc = bin.join("rustc");
    if !rustc.is_file() || !bin.join("cargo").is_file() {
        return None;
    }
    let found = cmd!(shell, "{rustc} --version")
        .quiet()
        .ignore_stderr()
        .read()
        .ok()?;
    let new_enough = Version::find(&found)? >= Tool::Compiler.oldest()?;
    let sysroot = cmd!(shell, "{rustc} --print sysroot")
        .quiet()
        .ignore_stderr()
        .read()
        .ok()?;
    new_enough.then(|| sysroot.into())
}

/// Returns true if a toolchain has a compiled core library for the target.
fn has_core(sysroot: &Path, architecture: Architecture) -> bool {
    let rustlib = sysroot.join("lib/rustlib");
    let libraries = rustlib.join(architecture.target()).join("lib");
    file_names(&libraries)
        .iter()
        .any(|name| name.starts_with("libcore-"))
}

/// Finds a linker that knows the target: the user's choice, one that comes with a compiler, LLVM's,
/// or GNU's.
fn find_linker(architecture: Architecture, sysroots: [Option<&Path>; 2]) -> Option<PathBuf> {
    let with_compiler = sysroots.into_iter().flatten().find_map(|sysroot| {
        let hosts = sysroot.join("lib/rustlib");
        let rust_lld = |host: &String| {
            hosts
                .join(host)
                .join("bin")
                .join(format!("rust-lld{EXE_SUFFIX}"))
        };
        file_names(&hosts)
            .iter()
            .map(rust_lld)
            .find(|path| path.is_file())
    });
    env::var_os(architecture.variable("LINKER"))
        .map(PathBuf::from)
        .or(with_compiler)
        .or_else(|| on_path("ld.lld"))
        .or_else(versioned_lld)
        .or_else(|| on_path("arm-none-eabi-ld"))
}

/// Returns the newest `ld.lld-NN` of the distribution.
fn versioned_lld() -> Option<PathBuf> {
    let number = |name: &String| {
        name.strip_prefix("ld.lld-")
            .and_then(|number| number.parse::<u32>().ok())
    };
    let names = file_names(Path::new(DISTRIBUTION_BIN));
    let newest = names
        .into_iter()
        .filter(|name| number(name).is_some())
        .max_by_key(number)?;
    Some(Path::new(DISTRIBUTION_BIN).join(newest))
}

/// Returns the first file of this program's name on the search path.
pub(crate) fn on_path(name: &str) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    env::split_paths(&path)
        // A relative directory would mean another place for every program that is started.
        .filter(|directory| directory.is_absolute())
        .map(|directory| directory.join(format!("{name}{EXE_SUFFIX}")))
        .find(|file| file.is_file())
}

/// Returns the names in a directory; none if it does not exist.
pub(crate) fn file_names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect()
}
