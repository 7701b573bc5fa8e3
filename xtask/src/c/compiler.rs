//! C compilers: GNU's for Arm, and that of this PC.

use std::path::{Path, PathBuf};

use anyhow::Result;
use xshell::{Cmd, cmd};

use crate::{
    machine::on_path,
    missing::Missing,
    tools::{Tool, Toolbox},
    workspace::Workspace,
};

/// Name of GNU's compiler for Arm.
const ARM: &str = "arm-none-eabi-gcc";

/// Flags by which the compiler finds what may be wrong. With a standard of C and not of GNU it
/// does not fuse multiplications and additions, so that bits are the same everywhere.
pub(super) const STRICT: [&str; 5] = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"];

/// A C compiler.
#[derive(Debug)]
pub(super) struct Compiler<'a> {
    workspace: &'a Workspace,
    program: PathBuf,
}

impl<'a> Compiler<'a> {
    /// Finds GNU's compiler for Arm on the search path, or fetches it.
    ///
    /// # Errors
    /// [`Missing`] if there is none and none can be fetched.
    pub(super) fn for_arm(
        workspace: &'a Workspace,
        toolbox: &Toolbox<'_>,
    ) -> Result<Self, Missing> {
        let program = match on_path(ARM) {
            Some(program) => program,
            None => toolbox.provide(Tool::ArmGcc)?.program(ARM),
        };
        workspace.tell(&format!("C compiler {}", program.display()));
        Ok(Self { workspace, program })
    }

    /// Returns the path of the compiler.
    pub(super) fn program(&self) -> &Path {
        &self.program
    }

    /// Returns a command that compiles C.
    pub(super) fn command(&self) -> Cmd<'a> {
        let Self { workspace, program } = self;
        cmd!(workspace.shell, "{program}").quiet()
    }
}

/// Returns the C compiler of this PC, if there is one.
pub(super) fn host_compiler(workspace: &Workspace) -> Option<Compiler<'_>> {
    let program = ["cc", "gcc", "clang"].into_iter().find_map(on_path)?;
    Some(Compiler { workspace, program })
}

/// Returns the C++ compiler of this PC, if there is one.
pub(super) fn host_compiler_of_cpp(workspace: &Workspace) -> Option<Compiler<'_>> {
    let program = ["c++", "g++", "clang++"].into_iter().find_map(on_path)?;
    Some(Compiler { workspace, program })
}

/// Returns an option with a path behind it.
pub(super) fn option(letter: &str, path: &Path) -> String {
    format!("-{letter}{}", path.display())
}
