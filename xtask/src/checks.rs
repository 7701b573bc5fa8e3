//! `cargo xtask test`: the steps in order, each announced and timed, up to the first that fails.

use std::{
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result};
use clap::ValueEnum;

use crate::{
    bench, board,
    firmware::{self, Image},
    kernel, no_panic,
    route::Need,
    target::Targets,
    verify,
    workspace::Workspace,
};

/// What is tested on the host: cargo's words for it. The same everywhere, so that nothing is built twice.
pub(crate) const TESTED: &str =
    "--workspace --exclude hil --features fmc-camera/nmea,fmc-camera/mavlink";

/// One step; its name is that of `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Step {
    /// Formatting
    Format,
    /// Lints for the host
    HostLints,
    /// Lints of the tests on a real board, which nothing else builds
    HilLints,
    /// Documentation
    Docs,
    /// Tests on the host
    HostTests,
    /// Verification against the strict solver, camera in-process
    Verify,
    /// Lints for the target
    TargetLints,
    /// Library built for the firmware's target, and for Cortex-M55
    TargetBuild,
    /// Link check that no panic is reachable, and its negative control
    NoPanic,
    /// Lints of the firmware
    FirmwareLints,
    /// Link check that the firmware cannot panic, and its negative control
    FirmwareNoPanic,
    /// Point kernel and firmware built, and tested in QEMU
    Firmware,
    /// Lints and image for the board, and what in it can panic
    Board,
    /// Instructions, image sizes and stack against the tables in docs
    Costs,
}

impl Step {
    fn name(self) -> String {
        self.to_possible_value()
            .map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn title(self) -> String {
        let value = self.to_possible_value();
        value
            .and_then(|value| value.get_help().map(ToString::to_string))
            .unwrap_or_default()
    }

    fn need(self) -> Option<Need> {
        match self {
            Self::Format
            | Self::HostLints
            | Self::HilLints
            | Self::Docs
            | Self::HostTests
            | Self::Verify => None,
            Self::TargetLints
            | Self::TargetBuild
            | Self::NoPanic
            | Self::FirmwareLints
            | Self::FirmwareNoPanic
            | Self::Board => Some(Need::Toolchain),
            Self::Firmware | Self::Costs => Some(Need::ToolchainAndQemu),
        }
    }
}

/// Runs all steps, or one, and says how to repeat the one that fails.
///
/// # Errors
/// Where a step or the set-up of the target fails.
pub(crate) fn run(workspace: &Workspace, only: Option<Step>) -> Result<ExitCode> {
    let start = Instant::now();
    let steps = only.map_or_else(|| Step::value_variants().to_vec(), |step| vec![step]);
    let _root = workspace.shell.push_dir(&workspace.root);
    // First of all, so that a machine that cannot build for a target says so at once.
    let need = steps.iter().filter_map(|step| step.need()).max();
    let targets = need
        .map(|need| Targets::set_up(workspace, need))
        .transpose()?;
    for (index, &step) in steps.iter().enumerate() {
        eprintln!("\n[{}/{}] {}", index + 1, steps.len(), step.title());
        let start = Instant::now();
        run_step(step, workspace, targets.as_ref()).with_context(|| {
            let name = step.name();
            format!("step {name} failed; run it again alone with `cargo xtask test --only {name}`")
        })?;
        eprintln!(
            "[{}/{}] passed in {}",
            index + 1,
            steps.len(),
            seconds(start.elapsed())
        );
    }
    let what = only.map_or_else(
        || format!("all {} steps", steps.len()),
        |step| format!("step {}", step.name()),
    );
    println!("xtask test: {what} passed in {}", seconds(start.elapsed()));
    Ok(ExitCode::SUCCESS)
}

fn run_step(step: Step, workspace: &Workspace, targets: Option<&Targets<'_>>) -> Result<()> {
    let targets = || targets.context("the targets are not set up");
    let target = || targets().map(|targets| &targets.armv7em);
    let command = match step {
        Step::Format => workspace.cargo("fmt --all --check"),
        Step::HostLints => workspace
            .cargo(&format!("clippy {TESTED} --all-targets --locked -- -D warnings")),
        Step::HilLints => {
            workspace.cargo("clippy --package hil --all-targets --locked -- -D warnings")
        }
        Step::Docs => {
            let doc = workspace.cargo(&format!("doc {TESTED} --no-deps --locked"));
            doc.env("RUSTDOCFLAGS", "-D warnings")
        }
        Step::HostTests => workspace.cargo(&format!("test {TESTED} --locked")),
        Step::Verify => {
            let host_sim = verify::tested_host_sim(workspace)?;
            let host_sim = workspace.shell.cmd(host_sim).quiet();
            let verify = host_sim.args(["verify", "--device", "sil", "--out"]);
            verify.arg(verify::default_out(workspace))
        }
        // In release, so that the core library is built once for lints, library and link check.
        Step::TargetLints => target()?.cargo(
            "clippy --release -p fmc-camera --lib -p fmc-camera-kernel -p kernel-check --bin kernel-check -p no-panic-check --bin no-panic-check -- -D warnings",
        ),
        Step::TargetBuild => {
            if let Some(helium) = &targets()?.helium {
                let build = helium.cargo("build --release -p fmc-camera --lib");
                eprintln!("$ {build}");
                build.run()?;
            }
            target()?.cargo("build --release -p fmc-camera --lib")
        }
        Step::NoPanic => return no_panic::check(workspace, target()?),
        Step::FirmwareLints => {
            firmware::lint(target()?, Image::Mps2)?;
            return firmware::lint(target()?, Image::Mps2WithDrills);
        }
        Step::FirmwareNoPanic => return firmware::check_no_panic(target()?),
        Step::Firmware => {
            kernel::test(workspace, targets()?)?;
            return firmware::test(workspace, target()?);
        }
        Step::Board => return board::check(workspace, target()?),
        Step::Costs => return bench::check(workspace, targets()?),
    };
    eprintln!("$ {command}");
    command.run().map_err(Into::into)
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}
