//! Programs of the crate registry, which cargo builds into target/tools where the search path has
//! none.

use std::{env::consts::EXE_SUFFIX, path::PathBuf};

use anyhow::{Context as _, Result};
use xshell::cmd;

use crate::{machine::on_path, workspace::Workspace};

/// A program of the crate registry.
#[derive(Debug)]
pub(crate) struct CrateProgram {
    /// Name of the program and of its crate.
    pub(crate) name: &'static str,
    /// Version; another of the same minor version is used where the search path has one.
    pub(crate) version: &'static str,
    /// Text before the version in the answer to `--version`.
    pub(crate) before_version: &'static str,
    /// Further arguments of `cargo install`.
    pub(crate) options: &'static str,
}

impl CrateProgram {
    /// Returns the program: that of the search path, or one that cargo has built.
    ///
    /// # Errors
    /// An error if it cannot be built.
    pub(crate) fn find(&self, workspace: &Workspace) -> Result<PathBuf> {
        let Self { name, version, .. } = *self;
        let shell = &workspace.shell;
        if let Some(program) = on_path(name) {
            // A command of cargo may want its own name first.
            let command = name.strip_prefix("cargo-");
            for before in [None, command] {
                let answer = cmd!(shell, "{program} {before...} --version").quiet();
                let answer = answer.ignore_stderr().read();
                if answer.is_ok_and(|answer| self.is_usable(&answer)) {
                    return Ok(program);
                }
            }
        }
        let place = workspace.target_dir.join("tools").join(name);
        let program = place.join(format!("{version}/bin/{name}{EXE_SUFFIX}"));
        if program.is_file() {
            return Ok(program);
        }
        let _lock = Workspace::lock(&place, &format!("builds {name}"))?;
        if program.is_file() {
            return Ok(program);
        }
        workspace.tell(&format!("building {name} into target/tools, once"));
        // Without optimisation it is built in half the time.
        let install = workspace.cargo(&format!(
            "install {name} --version ={version} --locked --debug --quiet {}",
            self.options
        ));
        let built = place.join("build");
        install
            .arg("--root")
            .arg(place.join(version))
            .arg("--target-dir")
            .arg(&built)
            .env("CARGO_PROFILE_DEV_DEBUG", "0")
            .run()
            .with_context(|| format!("cargo install {name}"))?;
        // Its intermediate files are larger than it is.
        let _ = std::fs::remove_dir_all(built);
        Ok(program)
    }

    fn is_usable(&self, answer: &str) -> bool {
        let minor = self.version.rsplit_once('.');
        let minor = minor.map_or(self.version, |(minor, _)| minor);
        answer
            .trim()
            .strip_prefix(self.before_version)
            .is_some_and(|version| version.starts_with(&format!("{minor}.")))
    }
}

#[cfg(test)]
mod tests {
    use crate::site::MDBOOK;

    #[test]
    fn another_minor_version_is_not_used() {
        assert!(MDBOOK.is_usable("mdbook v0.5.2\n"));
        assert!(!MDBOOK.is_usable("mdbook v0.4.52\n"));
        assert!(!MDBOOK.is_usable("mdbook v0.55.0\n"));
    }
}
