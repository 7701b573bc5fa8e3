//! Tools of the project: the distribution's packages of QEMU, a compiler and what belongs to it,
//! unpacked under `<target>/tools` and run from there. Nothing on the machine is installed or
//! changed, so that no privileges are needed and installed packages cannot conflict.
//!
//! A tool is a directory, `<target>/tools/<name>`, which is complete or absent. It is unpacked
//! beside its place, tried, and renamed. It contains `root` with the packages' files, `bin` with a
//! launcher per program that names the libraries of the packages, `status` with the list of
//! packages, and `release` with the name of their system.

mod apt;
mod closure;
mod unpacked;

use std::{
    cell::OnceCell,
    fmt, fs, io,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail};
use xshell::Shell;

use crate::{
    machine::{COMPILER_SOURCES, file_names, on_path},
    missing::{Missing, TooOld},
    system::System,
    version::Version,
    workspace::Workspace,
};
use apt::Apt;
pub(crate) use unpacked::Unpacked;

/// End of the name of a directory that is not complete yet.
const UNFINISHED: &str = ".new";

/// A tool that may be fetched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Tool {
    /// A compiler with its cargo and its library sources.
    Compiler,
    /// The same compiler's clippy.
    Clippy,
    /// A linker that knows the target.
    Linker,
    /// QEMU for Arm.
    Qemu,
    /// LLVM's disassembler and models of processors.
    Llvm,
    /// LLVM's programs that read coverage measurements of the compiler on the PC.
    Coverage,
    /// Python's installer of packages, with Python where there is none.
    Pip,
    /// Linker for 64-bit Arm and QEMU's emulation of its processes.
    Aarch64,
    /// GNU's C compiler for Arm, with a C library.
    ArmGcc,
    /// `CMake`.
    Cmake,
    /// Checker of C sources, with its rules of MISRA C.
    Cppcheck,
    /// Chromium without a window, and letters for its pictures.
    Browser,
    /// Gappa, which proves bounds of rounding.
    Gappa,
}

impl Tool {
    /// Returns the name of its directory.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Compiler => "compiler",
            Self::Clippy => "clippy",
            Self::Linker => "linker",
            Self::Qemu => "qemu",
            Self::Llvm => "llvm",
            Self::Coverage => "coverage",
            Self::Pip => "pip",
            Self::Aarch64 => "aarch64",
            Self::ArmGcc => "arm-gcc",
            Self::Cmake => "cmake",
            Self::Cppcheck => "cppcheck",
            Self::Browser => "browser",
            Self::Gappa => "gappa",
        }
    }

    /// Returns Debian's packages of the tool; the first one determines its version.
    pub(crate) fn packages(self) -> &'static [&'static str] {
        match self {
            Self::Compiler => &["rustc-web", "cargo-web", "rust-web-src"],
            Self::Clippy => &["rust-web-clippy"],
            Self::Linker => &["lld"],
            Self::Qemu => &["qemu-system-arm"],
            Self::Llvm => &["llvm-19"],
            Self::Coverage => &["llvm-22"],
            Self::Pip => &["python3-pip"],
            Self::Aarch64 => &[
                "gcc-aarch64-linux-gnu",
                "libc6-dev-arm64-cross",
                "qemu-user-static",
            ],
            Self::ArmGcc => &["gcc-arm-none-eabi"],
            Self::Cmake => &["cmake"],
            Self::Cppcheck => &["cppcheck"],
            Self::Browser => &["chromium-headless-shell", "fonts-dejavu-core"],
            Self::Gappa => &["gappa"],
        }
    }

    /// Returns the programs that are run; the first one is asked for its version.
    fn programs(self) -> &'static [&'static str] {
        match self {
            Self::Compiler => &["rustc", "cargo"],
            Self::Clippy => &["clippy-driver", "cargo-clippy"],
            Self::Linker => &["ld.lld"],
            Self::Qemu => &["qemu-system-arm"],
            Self::Llvm => &["llvm-mca-19", "llvm-objdump-19"],
            Self::Coverage => &["llvm-cov-22", "llvm-profdata-22"],
            // It is run as a module of a Python.
            Self::Pip => &[],
            Self::Aarch64 => &["aarch64-linux-gnu-gcc", "qemu-aarch64-static"],
            Self::ArmGcc => &["arm-none-eabi-gcc"],
            Self::Cmake => &["cmake"],
            Self::Cppcheck => &["cppcheck"],
            Self::Browser => &["chromium-headless-shell"],
            Self::Gappa => &["gappa"],
        }
    }

    /// Returns the directory of the programs, below the root of the packages.
    fn programs_directory(self) -> &'static str {
        match self {
            // The program of the search path is a script that names this place of the system.
            Self::Browser => "usr/lib/chromium",
            _ => "usr/bin",
        }
    }

    /// Returns the oldest version that is accepted, if an older one may occur.
    pub(crate) fn oldest(self) -> Option<Version> {
        match self {
            Self::Compiler => Version::find(env!("CARGO_PKG_RUST_VERSION")),
            Self::Qemu => Some(Version::new(7, 2)),
            Self::Clippy
            | Self::Linker
            | Self::Llvm
            | Self::Coverage
            | Self::Pip
            | Self::Aarch64
            | Self::ArmGcc
            | Self::Cmake
            | Self::Cppcheck
            | Self::Browser
            | Self::Gappa => None,
        }
    }

    /// Returns the tool whose libraries it needs, besides its own.
    fn rests_on(self) -> Option<Self> {
        (self == Self::Clippy).then_some(Self::Compiler)
    }

    /// Returns the files that it must have besides programs.
    fn files(self) -> &'static [&'static str] {
        match self {
            Self::Compiler => &[COMPILER_SOURCES],
            Self::Pip => &["lib/python3/dist-packages/pip/__init__.py"],
            _ => &[],
        }
    }
}

impl fmt::Display for Tool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Compiler => "compiler for the target",
            Self::Clippy => "clippy for the target",
            Self::Linker => "linker for the target",
            Self::Qemu => "QEMU",
            Self::Llvm => "LLVM",
            Self::Coverage => "LLVM's reader of coverage",
            Self::Pip => "Python with pip",
            Self::Aarch64 => "linker and emulator of 64-bit Arm",
            Self::ArmGcc => "C compiler for the target",
            Self::Cmake => "CMake",
            Self::Cppcheck => "checker of C sources",
            Self::Browser => "browser",
            Self::Gappa => "Gappa",
        })
    }
}

/// Directory of the tools, and what is needed to fill it.
#[derive(Debug)]
pub(crate) struct Toolbox<'a> {
    shell: &'a Shell,
    directory: PathBuf,
    system: System,
    /// Package lists, renewed when they are first needed.
    apt: OnceCell<Apt<'a>>,
}

impl<'a> Toolbox<'a> {
    /// Creates the toolbox of the workspace, without fetching anything.
    pub(crate) fn new(workspace: &'a Workspace) -> Self {
        Self {
            shell: &workspace.shell,
            directory: workspace.target_dir.join("tools"),
            system: System::here(),
            apt: OnceCell::new(),
        }
    }

    /// Returns the system that the tools are for.
    pub(crate) fn system(&self) -> &System {
        &self.system
    }

    /// Returns a tool that is present, of this system's release, and works.
    pub(crate) fn find(&self, tool: Tool) -> Option<Unpacked> {
        self.tried(tool).ok()
    }

    /// Returns a tool that is present, or else fetches it.
    ///
    /// # Errors
    /// [`Missing`] if it is not available; then nothing of it is left.
    pub(crate) fn provide(&self, tool: Tool) -> Result<Unpacked, Missing> {
        let fetched = self.find(tool).map_or_else(|| self.fetch(tool), Ok);
        fetched.map_err(|error| Missing::new(tool, &self.system, &error))
    }

    /// Returns the place of a tool after it has been provided.
    pub(crate) fn place(&self, tool: Tool) -> Unpacked {
        let base = tool.rests_on().map(|base| self.directory.join(base.name()));
        Unpacked::new(self.directory.join(tool.name()), base)
    }

    fn tried(&self, tool: Tool) -> Result<Unpacked> {
        let place = self.place(tool);
        place.try_out(self.shell, tool, &self.system.release)?;
        Ok(place)
    }

    /// Fetches a tool, with a lock against other programs of this kind.
    fn fetch(&self, tool: Tool) -> Result<Unpacked> {
        for program in ["apt-get", "apt-cache", "apt-config", "dpkg-deb"] {
            if on_path(program).is_none() {
                bail!("it is not here, and without {program} it cannot be fetched");
            }
        }
        let _lock = Workspace::lock(&self.directory, "fetches tools")?;
        self.remove_unfinished()?;
        // Another program may have fetched the tool in the meantime.
        if let Some(tool) = self.find(tool) {
            return Ok(tool);
        }
        let new = Unpacked::new(
            self.directory.join(format!("{}{UNFINISHED}", tool.name())),
            self.place(tool).base,
        );
        let fetched = self.fetch_into(tool, &new);
        if fetched.is_err() {
            // The error of the fetching is returned; an error of the removal is ignored.
            let _ = fs::remove_dir_all(&new.directory);
        }
        fetched?;
        self.tried(tool)
    }

    fn fetch_into(&self, tool: Tool, new: &Unpacked) -> Result<()> {
        let base = tool.rests_on().map(|base| self.place(base));
        let apt = self.renewed()?;
        let packages = apt.absent(tool, base.as_ref())?;
        if let (Some(oldest), Some(first)) = (tool.oldest(), tool.packages().first()) {
            let offered = packages.iter().find(|package| package.name == *first);
            let version = offered.and_then(closure::Package::upstream);
            if let Some(offered) = version.filter(|version| *version < oldest) {
                bail!(TooOld {
                    package: first,
                    offered,
                    oldest,
                });
            }
        }
        let count = match packages.len() {
            1 => "1 package".to_owned(),
            count => format!("{count} packages"),
        };
        let place = self.directory.join(tool.name());
        let release = &self.system.release;
        eprintln!(
            "xtask: fetching {tool}: {count} of {release} into {}",
            place.display()
        );
        apt.unpack(&packages, new)?;
        new.finish(tool, &self.system.release)?;
        new.try_out(self.shell, tool, &self.system.release)?;
        let place = self.place(tool);
        remove(&place.directory)?;
        fs::rename(&new.directory, &place.directory)
            .with_context(|| place.directory.display().to_string())
    }

    /// Removes what a program that was killed has left; the lock guarantees that no other program
    /// uses it.
    fn remove_unfinished(&self) -> Result<()> {
        for name in file_names(&self.directory) {
            if name.ends_with(UNFINISHED) {
                remove(&self.directory.join(name))?;
            }
        }
        Ok(())
    }

    fn renewed(&self) -> Result<&Apt<'a>> {
        if self.apt.get().is_none() {
            let apt = Apt::renewed(self.shell, self.directory.join("apt"))?;
            // The value cannot have been set since, because it is not shared between threads.
            let _ = self.apt.set(apt);
        }
        self.apt.get().context("the package lists")
    }
}

/// Removes a directory, which may be absent.
fn remove(directory: &Path) -> Result<()> {
    match fs::remove_dir_all(directory) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(error).with_context(|| directory.display().to_string())
        }
        _ => Ok(()),
    }
}
