//! What this machine offers for building for a target and running what is built: toolchains, linkers, QEMU, the right
//! to install.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use anyhow::Result;
use xshell::{Shell, cmd};

use crate::{
    route::{Architecture, Facts, QEMU, Toolchain, version},
    workspace::host_cargo,
};

/// Where Debian and Ubuntu put a compiler.
pub(crate) const DISTRIBUTION_BIN: &str = "/usr/bin";

/// The facts for [`crate::route::choose`], and what carrying the plan out needs besides.
#[derive(Debug)]
pub(crate) struct Machine {
    /// What the decision rests on.
    pub(crate) facts: Facts,
    /// A linker that knows the target.
    pub(crate) linker: Option<PathBuf>,
}

impl Machine {
    /// Looks at the machine; nothing is changed.
    ///
    /// # Errors
    /// Where the active compiler does not answer.
    pub(crate) fn look(shell: &Shell, architecture: Architecture) -> Result<Self> {
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let active = PathBuf::from(cmd!(shell, "{rustc} --print sysroot").quiet().read()?);
        let cargo = host_cargo();
        let active_has_clippy = cmd!(shell, "{cargo} clippy --version")
            .quiet()
            .ignore_stderr()
            .read()
            .is_ok();
        let distribution = distribution_sysroot(shell);

        let bin = Path::new(DISTRIBUTION_BIN);
        let offers = |sysroot: &Path, clippy| Toolchain {
            target_core: has_core(sysroot, architecture),
            library_sources: sysroot
                .join("lib/rustlib/src/rust/library/core/Cargo.toml")
                .is_file(),
            clippy,
        };
        let linker = find_linker(
            architecture,
            [Some(active.as_path()), distribution.as_deref()],
        );
        Ok(Self {
            facts: Facts {
                active: offers(&active, active_has_clippy),
                distribution: distribution
                    .as_deref()
                    .map_or_else(Toolchain::default, |sysroot| {
                        offers(
                            sysroot,
                            bin.join("cargo-clippy").is_file()
                                && bin.join("clippy-driver").is_file(),
                        )
                    }),
                linker: linker.is_some(),
                qemu: on_path(QEMU).is_some(),
                may_install: bin.join("apt-get").is_file()
                    && cmd!(shell, "id -u")
                        .quiet()
                        .read()
                        .is_ok_and(|user| user == "0"),
            },
            linker,
        })
    }
}

/// Root of the distribution's toolchain, where there is one with a cargo that is new enough for this workspace.
fn distribution_sysroot(shell: &Shell) -> Option<PathBuf> {
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
    let new_enough = version(&found)? >= version(env!("CARGO_PKG_RUST_VERSION"))?;
    let sysroot = cmd!(shell, "{rustc} --print sysroot")
        .quiet()
        .ignore_stderr()
        .read()
        .ok()?;
    new_enough.then(|| sysroot.into())
}

/// Whether a toolchain has a compiled core library for the target.
fn has_core(sysroot: &Path, architecture: Architecture) -> bool {
    let rustlib = sysroot.join("lib/rustlib");
    let libraries = rustlib.join(architecture.target()).join("lib");
    file_names(&libraries)
        .iter()
        .any(|name| name.starts_with("libcore-"))
}

/// A linker that knows the target: the user's choice, one that comes with a compiler, LLVM's, or GNU's.
fn find_linker(architecture: Architecture, sysroots: [Option<&Path>; 2]) -> Option<PathBuf> {
    let with_compiler = sysroots.into_iter().flatten().find_map(|sysroot| {
        let hosts = sysroot.join("lib/rustlib");
        let rust_lld = |host: &String| hosts.join(host).join("bin/rust-lld");
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

/// The newest `ld.lld-NN` of the distribution.
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

/// First executable of this name on the search path.
fn on_path(name: &str) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    env::split_paths(&path)
        .map(|directory| directory.join(name))
        .find(|file| file.is_file())
}

/// Names in a directory; none where it does not exist.
fn file_names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect()
}
