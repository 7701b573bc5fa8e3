//! Build of the wheel by maturin.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail};

use super::CRATE;
use crate::{
    python::Python,
    workspace::{Workspace, host_cargo},
};

/// Linker of the wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Link {
    /// This machine's: the wheel is for systems like it.
    System,
    /// zig: the wheel is for every system with glibc 2.17 or later.
    Zig,
}

/// Builds the wheel into a directory that then holds nothing else, and returns it.
pub(super) fn wheel(
    workspace: &Workspace,
    python: &Python,
    link: Link,
    directory: &Path,
) -> Result<PathBuf> {
    if directory.exists() {
        fs::remove_dir_all(directory).with_context(|| directory.display().to_string())?;
    }
    let maturin = python.brought("maturin")?;
    let mut command = python
        .program(&workspace.shell, &maturin)
        .quiet()
        .env("CARGO", host_cargo());
    command = command.args(["build", "--locked", "--strip", "--manifest-path"]);
    command = command.arg(workspace.root.join(CRATE).join("Cargo.toml"));
    command = command.arg("--target-dir").arg(&workspace.target_dir);
    command = command.args(["--profile", "wheel", "--out"]).arg(directory);
    command = match link {
        Link::System => command.args(["--compatibility", "linux"]),
        Link::Zig => {
            // Its library is built once, and stays in the target directory.
            let cache = workspace.target_dir.join("tools/zig-cache");
            command.env("ZIG_GLOBAL_CACHE_DIR", cache).args([
                "--zig",
                "--compatibility",
                "manylinux2014",
            ])
        }
    };
    eprintln!("$ {command}");
    command.run()?;
    let entries = fs::read_dir(directory).with_context(|| directory.display().to_string())?;
    let mut wheels = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension() == Some(OsStr::new("whl")));
    match (wheels.next(), wheels.next()) {
        (Some(wheel), None) => Ok(wheel),
        _ => bail!(
            "maturin has not written one wheel into {}",
            directory.display()
        ),
    }
}
