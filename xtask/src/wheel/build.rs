//! Build of the wheels by maturin.

use std::{
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail, ensure};

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

/// A wheel, and what it may take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wheel {
    /// Directory of its crate, from the root.
    pub(super) directory: &'static str,
    /// Name with which its file begins.
    pub(super) file: &'static str,
    /// Largest size, bytes.
    pub(super) largest: u64,
}

impl Wheel {
    /// Builds the wheel into a directory, and returns its path.
    ///
    /// # Errors
    /// An error if the build fails, or if the wheel is larger than it may be.
    pub(super) fn build(
        self,
        workspace: &Workspace,
        python: &Python,
        link: Link,
        directory: &Path,
    ) -> Result<PathBuf> {
        maturin(workspace, python, link, self.directory, directory)?;
        let wheel = self.found(directory)?;
        let size = fs::metadata(&wheel)
            .with_context(|| wheel.display().to_string())?
            .len();
        eprintln!("{}: {size} bytes", wheel.display());
        ensure!(
            size <= self.largest,
            "the wheel is larger than {} bytes",
            self.largest
        );
        Ok(wheel)
    }

    /// Returns the one file of this wheel.
    fn found(self, directory: &Path) -> Result<PathBuf> {
        let entries = fs::read_dir(directory).with_context(|| directory.display().to_string())?;
        let begins = format!("{}-", self.file);
        let mut wheels = entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension() == Some(OsStr::new("whl")))
            .filter(|path| {
                let name = path.file_name().and_then(OsStr::to_str);
                name.is_some_and(|name| name.starts_with(&begins))
            });
        match (wheels.next(), wheels.next()) {
            (Some(wheel), None) => Ok(wheel),
            _ => bail!(
                "maturin has not written one wheel {} into {}",
                self.file,
                directory.display()
            ),
        }
    }
}

/// Runs the builder.
fn maturin(
    workspace: &Workspace,
    python: &Python,
    link: Link,
    source: &str,
    directory: &Path,
) -> Result<()> {
    let maturin = python.brought("maturin")?;
    let mut command = python
        .program(&workspace.shell, &maturin)
        .quiet()
        .env("CARGO", host_cargo());
    command = command.args(["build", "--locked", "--strip", "--manifest-path"]);
    command = command.arg(workspace.root.join(source).join("Cargo.toml"));
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
    command.run().map_err(Into::into)
}
