//! Tests for 64-bit Arm: those of the vectors of NEON, in QEMU's emulation of a process, or on the
//! machine itself if it is one.

use std::{path::PathBuf, process::ExitCode};

use anyhow::Result;
use xshell::Cmd;

use crate::{
    machine::on_path,
    other_target::OtherTarget,
    tools::{Tool, Toolbox},
    workspace::Workspace,
};

/// Compiler's name of the target.
const TARGET: &str = "aarch64-unknown-linux-gnu";

/// Arguments of the tests: of the crate with the vectors. Ten million points would take minutes in
/// emulation.
const TESTS: &str = "--package fmc-camera-kernel --features resampling -- --skip ten_million";

/// Runs the tests.
///
/// # Errors
/// An error if a test fails, or if there is no compiler, linker or emulator and none can be
/// fetched.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let toolbox = Toolbox::new(workspace);
    let target = if cfg!(target_arch = "aarch64") {
        Target::Native
    } else {
        Target::emulated(workspace, &toolbox)?
    };
    let command = target.test(workspace).args(TESTS.split_whitespace());
    eprintln!("$ {command}");
    command.run()?;
    Ok(ExitCode::SUCCESS)
}

/// Way in which a test is built and run.
#[derive(Debug)]
enum Target {
    /// This machine.
    Native,
    /// Another compiler or none, a linker, and an emulator.
    Emulated {
        target: OtherTarget,
        linker: PathBuf,
        runner: PathBuf,
    },
}

impl Target {
    fn emulated(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<Self> {
        let target = OtherTarget::find(workspace, toolbox, TARGET, "std")?;
        let [linker, runner] = ["aarch64-linux-gnu-gcc", "qemu-aarch64-static"];
        let (linker, runner) = if let (Some(linker), Some(runner)) =
            (on_path(linker), on_path(runner).or(on_path("qemu-aarch64")))
        {
            (linker, runner)
        } else {
            let tool = toolbox.provide(Tool::Aarch64)?;
            (tool.program(linker), tool.program(runner))
        };
        workspace.tell(&format!(
            "{}, linker {}, emulator {}",
            target.description(),
            linker.display(),
            runner.display()
        ));
        Ok(Self::Emulated {
            target,
            linker,
            runner,
        })
    }

    /// Returns the command of tests with optimisation.
    fn test<'a>(&self, workspace: &'a Workspace) -> Cmd<'a> {
        let (target, linker, runner) = match self {
            Self::Native => return workspace.cargo("test --locked --release"),
            Self::Emulated {
                target,
                linker,
                runner,
            } => (target, linker, runner),
        };
        target
            .cargo(workspace, "test")
            .env(target.variable("LINKER"), linker)
            .env(target.variable("RUNNER"), runner)
            // The emulator then needs no libraries of the target.
            .env(target.variable("RUSTFLAGS"), "-Ctarget-feature=+crt-static")
            .arg("--target-dir")
            .arg(workspace.target_dir.join("aarch64"))
    }
}
