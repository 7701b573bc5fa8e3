//! mdBook, which makes pages of the documents.

use std::{env::consts::EXE_SUFFIX, path::PathBuf};

use anyhow::{Context as _, Result};
use xshell::cmd;

use crate::{machine::on_path, workspace::Workspace};

/// Its version; another of the same minor version is used where the search path has one.
const VERSION: &str = "0.5.4";

/// Returns the program: that of the search path, or one that cargo has built into target/tools.
///
/// # Errors
/// An error if it cannot be built.
pub(super) fn find(workspace: &Workspace) -> Result<PathBuf> {
    let shell = &workspace.shell;
    if let Some(program) = on_path("mdbook") {
        let version = cmd!(shell, "{program} --version").quiet().read();
        if version.is_ok_and(|version| is_usable(&version)) {
            return Ok(program);
        }
    }
    let place = workspace.target_dir.join("tools/mdbook");
    let program = place.join(format!("{VERSION}/bin/mdbook{EXE_SUFFIX}"));
    if program.is_file() {
        return Ok(program);
    }
    let _lock = Workspace::lock(&place, "builds mdBook")?;
    if program.is_file() {
        return Ok(program);
    }
    workspace.tell("building mdBook into target/tools, once");
    // Without optimisation it is built in half the time, and makes the site in a second.
    let install = workspace.cargo(&format!(
        "install mdbook --version ={VERSION} --locked --no-default-features --debug --quiet"
    ));
    let built = place.join("build");
    install
        .arg("--root")
        .arg(place.join(VERSION))
        .arg("--target-dir")
        .arg(&built)
        .env("CARGO_PROFILE_DEV_DEBUG", "0")
        .run()
        .context("cargo install mdbook")?;
    // Its intermediate files are larger than it is.
    let _ = std::fs::remove_dir_all(built);
    Ok(program)
}

fn is_usable(version: &str) -> bool {
    let minor = VERSION.rsplit_once('.').map_or(VERSION, |(minor, _)| minor);
    version
        .trim()
        .strip_prefix("mdbook v")
        .is_some_and(|version| version.starts_with(&format!("{minor}.")))
}

#[cfg(test)]
mod tests {
    use super::is_usable;

    #[test]
    fn another_minor_version_is_not_used() {
        assert!(is_usable("mdbook v0.5.2\n"));
        assert!(!is_usable("mdbook v0.4.52\n"));
        assert!(!is_usable("mdbook v0.55.0\n"));
    }
}
