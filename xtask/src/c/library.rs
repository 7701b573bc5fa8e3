//! The static library of a target.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};

use super::CRATE;
use crate::{route::Architecture, target::Target, workspace::Workspace};

/// Package and what cargo calls its archive.
const PACKAGE: &str = "fmc-camera-c";
/// Profile of the library for a core, which is small.
const PROFILE: &str = "c-library";
const ARCHIVE: &str = "libfmc_camera_c.a";

/// Name of the archive as it is given to others.
pub(super) const NAME: &str = "libfmc_camera.a";

/// A library that has been built.
#[derive(Debug)]
pub(super) struct Library {
    pub(super) architecture: Architecture,
    /// The archive.
    pub(super) path: PathBuf,
}

/// A machine of QEMU that runs a library's programs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Board {
    /// Name of the machine.
    pub(super) machine: &'static str,
    /// Linker script, in the examples.
    pub(super) script: &'static str,
    /// Flags of the C compiler.
    pub(super) flags: &'static [&'static str],
}

impl Library {
    /// Builds the library of a target and copies it to its place.
    ///
    /// # Errors
    /// An error if the build fails.
    pub(super) fn build(
        workspace: &Workspace,
        target: &Target<'_>,
        architecture: Architecture,
        out: &Path,
    ) -> Result<Self> {
        let made = archive(target, &[])?;
        let directory = out.join("lib").join(architecture.target());
        let path = directory.join(NAME);
        fs::create_dir_all(&directory).with_context(|| directory.display().to_string())?;
        workspace.shell.copy_file(made, &path)?;
        Ok(Self { architecture, path })
    }

    /// Returns the machine of the library.
    pub(super) fn board(&self) -> Board {
        board(self.architecture)
    }
}

/// Returns the machine of an architecture.
fn board(architecture: Architecture) -> Board {
    match architecture {
        Architecture::Armv7em => Board {
            machine: "mps2-an386",
            script: "mps2.ld",
            flags: &["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"],
        },
        Architecture::Armv7emSoft => Board {
            machine: "mps2-an386",
            script: "mps2.ld",
            flags: &["-mcpu=cortex-m4", "-mfloat-abi=soft"],
        },
        Architecture::Armv8m | Architecture::Helium => Board {
            machine: "mps3-an547",
            script: "mps3.ld",
            flags: &["-mcpu=cortex-m33", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard"],
        },
    }
}

/// Builds the firmware's library with the functions that checks need.
///
/// # Errors
/// An error if the build fails.
pub(super) fn with_control(
    workspace: &Workspace,
    target: &Target<'_>,
    out: &Path,
) -> Result<Library> {
    let made = archive(target, &["--cfg", "control"])?;
    let path = out.join("control.a");
    workspace.shell.copy_file(made, &path)?;
    Ok(Library {
        architecture: Architecture::Armv7em,
        path,
    })
}

/// Builds the archive of a target with arguments of the compiler, and returns its place.
fn archive(target: &Target<'_>, arguments: &[&str]) -> Result<PathBuf> {
    // A package that is a library for Rust, too, is not optimised as a whole.
    let line = format!("rustc --profile {PROFILE} -p {PACKAGE} --lib --crate-type staticlib --");
    let build = target.cargo(&line).args(arguments);
    eprintln!("$ {build}");
    build.run()?;
    Ok(target.made_with(PROFILE).join(ARCHIVE))
}

/// Builds the library for this PC.
///
/// # Errors
/// An error if the build fails.
pub(super) fn for_host(workspace: &Workspace, out: &Path) -> Result<PathBuf> {
    let build = workspace.cargo(&format!("build --release --locked -p {PACKAGE}"));
    eprintln!("$ {build}");
    build.run()?;
    let directory = out.join("lib/host");
    fs::create_dir_all(&directory).with_context(|| directory.display().to_string())?;
    let path = directory.join(NAME);
    let made = workspace.target_dir.join("release").join(ARCHIVE);
    workspace.shell.copy_file(made, &path)?;
    Ok(path)
}

/// Returns a directory of the crate.
pub(super) fn directory(workspace: &Workspace, name: &str) -> PathBuf {
    workspace.root.join(CRATE).join(name)
}
