//! Steps of `cargo xtask test`: what each needs and runs. [`crate::schedule`] determines their
//! order.

use std::{fs, process::ExitCode, time::Instant};

use anyhow::Result;
use clap::ValueEnum;

use crate::{
    CHECK_FAILED, NOT_STARTED, bench, board, board_flight, c,
    equipment::{Equipment, Need},
    exchange,
    firmware::{self, Image},
    kernel, mutants, no_panic, overflow, rounding, schedule, site, supply, verify, web, wheel,
    workspace::Workspace,
};

/// Cargo's arguments for the tests on the host, the same everywhere, so that cargo builds nothing
/// twice.
pub(crate) const TESTED: &str =
    "--workspace --exclude hil --features fmc-camera/nmea,fmc-camera/mavlink,fmc-camera/store";

/// Features of the library with which it is tested.
pub(crate) const FEATURES_OF_TESTS: &str = "estimation,nmea,mavlink,store";

/// Features of the library, each of which must compile by itself, and none of them.
const FEATURES: [&str; 8] = [
    "",
    "defmt",
    "estimation",
    "link",
    "mavlink",
    "nmea",
    "serde",
    "store",
];

/// One step; its name is that of `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Step {
    /// Check the formatting
    Format,
    /// Lint for the host: the library with each feature by itself, then everything
    HostLints,
    /// Lint the tests for a real board, which no other step builds
    HilLints,
    /// Build the documentation
    Docs,
    /// Build the documents as a site, and check its links
    Site,
    /// Compare what each image holds with docs/supply-chain.csv, and check licences and versions
    Supply,
    /// Run the tests on the host
    HostTests,
    /// Verify every coordinate against the strict solver, with the camera in this process
    Verify,
    /// Fly a twentieth of the campaign of faults, with the camera in this process
    Campaign,
    /// Try the mutants of sources in docs/mutants.csv that have changed since
    Mutants,
    /// Prove the bounds of the rounding with Gappa
    Rounding,
    /// Let `OpenCV` and COLMAP read exported cameras and project points
    Exchange,
    /// Build the wheel for Python, and test it with `NumPy`, Polars, `DuckDB` and Dask
    Python,
    /// Lint for the target: library, firmware, and the programs that check them
    TargetLints,
    /// Build the library for the firmware's target and for a Cortex-M55
    TargetBuild,
    /// Link the library's public functions so that a reachable panic is an error, and show that the
    /// check finds one
    NoPanic,
    /// Compare the places where arithmetic can overflow, as far as the compiler can tell, with the
    /// bounds in docs/overflow.csv, and show that a place without one is found
    Overflow,
    /// Lint the firmware with drills: faults that a test triggers
    FirmwareLints,
    /// Link the firmware so that a reachable panic is an error, and show that the check finds one
    FirmwareNoPanic,
    /// Build the point kernel and the firmware, and test them in QEMU
    Firmware,
    /// Lint and build the image for the board, and check which functions in it can panic
    Board,
    /// Fly the image for the board on a model of its chip, under `host-sim`
    BoardFlight,
    /// Leave out instructions of that image, one at a time, from the look at the stage's speed to
    /// the shutter's command and while a signature is checked: an eighth of them, or every one with
    /// `FMC_SKIPS=all`
    Skips,
    /// Build the library for C, and run its programs on this PC and in QEMU
    C,
    /// Build the page with the camera's code as WebAssembly, and drive it in a browser
    Web,
    /// Compare instructions, image sizes and stack with the tables in docs
    Costs,
}

impl Step {
    pub(crate) fn name(self) -> String {
        self.to_possible_value()
            .map_or_else(String::new, |value| value.get_name().to_owned())
    }

    pub(crate) fn title(self) -> String {
        let value = self.to_possible_value();
        value
            .and_then(|value| value.get_help().map(ToString::to_string))
            .unwrap_or_default()
    }

    /// Returns what the step needs besides the host's toolchain.
    pub(crate) fn needs(self) -> &'static [Need] {
        match self {
            Self::Format
            | Self::HostLints
            | Self::HilLints
            | Self::Docs
            | Self::Site
            | Self::Supply
            | Self::HostTests
            | Self::Verify
            | Self::Campaign
            | Self::Mutants
            | Self::Exchange
            | Self::Python
            | Self::Web => &[],
            Self::Rounding => &[Need::Gappa],
            Self::TargetLints | Self::FirmwareLints | Self::Board => {
                &[Need::Compiler, Need::Clippy]
            }
            Self::TargetBuild
            | Self::NoPanic
            | Self::Overflow
            | Self::FirmwareNoPanic
            | Self::BoardFlight
            | Self::Skips => &[Need::Compiler],
            Self::Firmware | Self::C | Self::Costs => &[Need::Compiler, Need::Qemu],
        }
    }
}

/// Runs all steps, or one.
///
/// # Errors
/// An error if the steps cannot be started.
pub(crate) fn run(workspace: &Workspace, only: Option<Step>) -> Result<ExitCode> {
    let Some(step) = only else {
        return schedule::run(workspace);
    };
    let start = Instant::now();
    let equipment = Equipment::for_needs(workspace, step.needs());
    if let Some(lack) = equipment.lack(step.needs()) {
        eprintln!("xtask: step {} was not run: {lack}", step.name());
        return Ok(ExitCode::from(NOT_STARTED));
    }
    let _root = workspace.shell.push_dir(&workspace.root);
    if let Err(error) = run_step(step, workspace, &equipment) {
        eprintln!("xtask: {}: {error:#}", failure(step));
        return Ok(ExitCode::from(CHECK_FAILED));
    }
    let (name, time) = (step.name(), start.elapsed().as_secs_f64());
    println!("xtask test: step {name} passed in {time:.1} s");
    Ok(ExitCode::SUCCESS)
}

/// Returns the message for a step that failed.
pub(crate) fn failure(step: Step) -> String {
    let name = step.name();
    format!("step {name} failed; run it again alone with `cargo xtask test --only {name}`")
}

/// Flies a twentieth of the campaign anew, which takes a minute.
fn campaign(workspace: &Workspace) -> Result<()> {
    let host_sim = verify::tested_host_sim(workspace)?;
    let out = workspace.target_dir.join("campaign");
    // Otherwise a campaign of the same program would only be read again.
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    let host_sim = workspace.shell.cmd(host_sim).quiet();
    let campaign = host_sim.args(["campaign", "--quick", "--out"]).arg(out);
    Ok(campaign.run()?)
}

fn run_step(step: Step, workspace: &Workspace, equipment: &Equipment<'_>) -> Result<()> {
    let target = || equipment.targets().map(|targets| &targets.armv7em);
    let command = match step {
        Step::Format => workspace.cargo("fmt --all --check"),
        Step::HostLints => {
            for feature in FEATURES {
                let alone = workspace.cargo(&format!(
                    "clippy -p fmc-camera --lib --no-default-features --features={feature} --locked -- -D warnings"
                ));
                eprintln!("$ {alone}");
                alone.run()?;
            }
            workspace.cargo(&format!("clippy {TESTED} --all-targets --locked -- -D warnings"))
        }
        Step::HilLints => {
            workspace.cargo("clippy --package hil --all-targets --locked -- -D warnings")
        }
        Step::Docs => {
            let doc = workspace.cargo(&format!("doc {TESTED} --no-deps --locked"));
            doc.env("RUSTDOCFLAGS", "-D warnings")
        }
        Step::Site => return site::check(workspace),
        Step::Supply => return supply::check(workspace),
        // All of them, so that one run names every test that fails.
        Step::HostTests => workspace.cargo(&format!("test {TESTED} --locked --no-fail-fast")),
        Step::Verify => {
            let host_sim = verify::tested_host_sim(workspace)?;
            let host_sim = workspace.shell.cmd(host_sim).quiet();
            let verify = host_sim.args(["verify", "--device", "sil", "--out"]);
            verify.arg(verify::default_out(workspace))
        }
        Step::Campaign => return campaign(workspace),
        Step::Mutants => return mutants::check(workspace),
        Step::Rounding => return rounding::check(workspace, equipment.gappa()?),
        Step::Exchange => return exchange::check(workspace, equipment.toolbox()),
        Step::Python => return wheel::check(workspace, equipment.toolbox()),
        // The lints run in release, so that the core library is built once for lints, library and
        // link check.
        Step::TargetLints => target()?.cargo(
            "clippy --release -p fmc-camera --lib --bin firmware --features fmc-camera/board-mps2 -p fmc-camera-kernel -p kernel-check --bin kernel-check -p no-panic-check --bin no-panic-check -- -D warnings",
        ),
        Step::TargetBuild => {
            if let Some(helium) = &equipment.targets()?.helium {
                let build = helium.cargo("build --release -p fmc-camera --lib");
                eprintln!("$ {build}");
                build.run()?;
            }
            target()?.cargo("build --release -p fmc-camera --lib")
        }
        Step::NoPanic => return no_panic::check(workspace, target()?),
        Step::Overflow => return overflow::check(workspace, target()?),
        Step::FirmwareLints => return firmware::lint(target()?, Image::Mps2WithDrills),
        Step::FirmwareNoPanic => return firmware::check_no_panic(target()?),
        Step::Firmware => {
            let emulator = equipment.emulator()?;
            kernel::test(workspace, equipment.targets()?, emulator)?;
            return firmware::test(workspace, target()?, emulator);
        }
        Step::Board => return board::check(workspace, target()?),
        Step::BoardFlight => {
            return board_flight::check(workspace, target()?, equipment.toolbox(), &[]);
        }
        Step::Skips => {
            let tests = &board_flight::SKIPS;
            return board_flight::check(workspace, target()?, equipment.toolbox(), tests);
        }
        Step::C => {
            let target = target()?;
            return c::check(workspace, target, equipment.emulator()?, equipment.toolbox());
        }
        Step::Web => return web::check(workspace, equipment.toolbox()),
        Step::Costs => {
            let targets = equipment.targets()?;
            return bench::check(workspace, targets, equipment.emulator()?, equipment.toolbox());
        }
    };
    eprintln!("$ {command}");
    command.run().map_err(Into::into)
}
