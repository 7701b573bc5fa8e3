//! Commands of the README: `cargo xtask verify`, `test` and others.
//!
//! Each command does its own set-up, so that a fresh machine needs no other command. [`route`]
//! decides how the target is built, [`machine`] collects the facts for that decision, [`tools`]
//! fetches what is absent, and [`target`] and [`emulator`] carry it out; [`firmware`] builds the
//! images, [`mod@bench`] counts what they cost, [`checks`] is the list of steps of `test`, and
//! [`schedule`] their order.

mod aarch64;
mod bench;
mod board;
mod board_flight;
mod c;
mod checks;
mod cores;
mod coverage;
mod crate_program;
mod emulator;
mod equipment;
mod exchange;
mod firmware;
mod fuzz;
mod kernel;
mod machine;
mod missing;
mod mutants;
mod no_panic;
mod other_target;
mod overflow;
mod python;
mod rounding;
mod route;
mod schedule;
mod site;
mod source;
mod stack;
mod supply;
mod system;
mod target;
mod tools;
mod verify;
mod version;
mod web;
mod wheel;
mod workspace;

use std::{ffi::OsString, process::ExitCode};

use clap::{Parser, Subcommand};

use crate::{checks::Step, workspace::Workspace};

/// Builds and checks of the fmc-camera workspace.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Verify every coordinate against the strict solver; arguments go on to `host-sim verify`,
    /// `--help` too
    #[command(disable_help_flag = true)]
    Verify {
        /// Arguments of `host-sim verify`; without `--out` the report goes to target/verify
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Build the firmware for QEMU and print where it is
    Firmware,
    /// Count what a point, a frame and a message cost
    ///
    /// Prints, as CSV, the instructions on the emulated cores, the modelled cycles, and the time on
    /// this PC beside that of other software, and on the error stream the sizes of the images and
    /// their stack.
    ///
    /// Cycles need LLVM's llvm-mca and llvm-objdump, of 19 or later; where they are not on the
    /// search path, Debian's package llvm-19 is fetched into the target directory. `OpenCV` is
    /// timed where `python3` has it. The comparison goes to performance.csv and performance.svg in
    /// target/bench.
    Bench {
        /// Write the tables and the figure to docs instead of target/bench
        #[arg(long)]
        update: bool,
    },
    /// Run the tests of the vectors of 64-bit Arm (NEON)
    ///
    /// In QEMU's emulation of a process, or on this machine if it is one. Where they are not on the
    /// search path, Debian's packages gcc-aarch64-linux-gnu and qemu-user-static are fetched into
    /// the target directory, and its compiler, if the active one has no library for the target
    /// (rustup target add aarch64-unknown-linux-gnu).
    Aarch64,
    /// Build the C library into target/c, and run its example in QEMU and on this PC
    ///
    /// The library for Cortex-M4F and M7, for the same without floating point, for Cortex-M33 and
    /// for this PC, the header, and files for pkg-config, `CMake` and Zephyr.
    C {
        /// Write the sizes to docs/footprint.csv
        #[arg(long)]
        update: bool,
    },
    /// Build the wheel for Python into target/python, and test it
    ///
    /// Python's packages are fetched into the target directory. The wheel is for glibc 2.17 and
    /// later where zig can be fetched. Spark is tested where there is Java, and times are taken.
    Python,
    /// Build the page that computes with the camera's own code, and check it in a browser
    ///
    /// The page goes to target/web. Where the active compiler has no library for the target (rustup
    /// target add wasm32-unknown-unknown), Debian's is fetched into the target directory, and so is
    /// Chromium where none is on the search path.
    Web {
        /// Write the page to docs/demo
        #[arg(long)]
        update: bool,
    },
    /// Build the documents as a site of pages into target/site, and check its links
    ///
    /// By `mdBook` 0.5, which cargo builds into target/tools where the search path has none.
    Docs,
    /// Check what each image holds against docs/supply-chain.csv, and licences and versions
    Supply {
        /// Write the list to docs/supply-chain.csv
        #[arg(long)]
        update: bool,
    },
    /// Measure which lines and branches of the camera logic and of the link the library's own tests
    /// reach, and compare what they do not with docs/coverage.csv
    ///
    /// Needs LLVM's llvm-cov and llvm-profdata of the compiler's own version; where they are not on
    /// the search path, Debian's package is fetched into the target directory. cargo builds
    /// cargo-llvm-cov into target/tools where the search path has none.
    Coverage,
    /// Change the library in one place after the other, and see whether its own tests notice
    ///
    /// Changes are those of cargo-mutants, which cargo builds into target/tools where the search
    /// path has none, and either constant for each condition of several. Those that survive are
    /// compared with docs/equivalent-mutants.csv. A run that was interrupted goes on where it was.
    /// On Linux alone.
    Mutants {
        /// Sources, from the root; all of src/geometry, src/flight and src/io without any
        files: Vec<String>,
        /// Try a part of the mutants: 1/4 is the first of four
        #[arg(long)]
        shard: Option<mutants::Shard>,
        /// Enter sources without unexplained survivors in docs/mutants.csv
        #[arg(long, conflicts_with = "shard")]
        update: bool,
    },
    /// Feed hostile input to what reads it, guided by what the code has not done yet
    ///
    /// Targets and their properties are in fuzz. Needs a C++ compiler for libFuzzer; cargo builds
    /// cargo-fuzz into target/tools where the search path has none. Input that fails stays in
    /// target/fuzz/artifacts/TARGET, new input in target/fuzz/found/TARGET.
    Fuzz {
        /// Targets; all without any
        targets: Vec<String>,
        /// Time for each, s
        #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..))]
        seconds: u32,
        /// Add to fuzz/corpus the smallest set of the new input that reaches all that was reached
        #[arg(long)]
        keep: bool,
    },
    /// Check formatting, lints, documentation and tests
    ///
    /// On the host: formatting, lints, documentation and tests. For the target: lints, builds, and
    /// checks that no panic can be reached. In QEMU: the tests of the firmware. In Unicorn: the
    /// image for the board in flight, on a model of its chip.
    Test {
        /// Run this step alone
        #[arg(long, value_enum)]
        only: Option<Step>,
        /// Run the step as one of several: the tools in use have been printed already
        #[arg(long, hide = true, requires = "only")]
        among_others: bool,
    },
}

/// Exit code of a check that was run and failed.
pub(crate) const CHECK_FAILED: u8 = 1;
/// Beginning of the line that names a check that was left out for lack of a tool in a step that
/// passes.
pub(crate) const NOT_CHECKED: &str = "xtask: not checked: ";

/// Exit code if a check could not be run, so that it says nothing about the camera, or if the
/// firmware was not built.
pub(crate) const NOT_STARTED: u8 = 3;

fn main() -> ExitCode {
    let (result, code_of_error) = match Arguments::parse().command {
        Command::Verify { arguments } => (
            Workspace::new().and_then(|workspace| verify::run(&workspace, arguments)),
            NOT_STARTED,
        ),
        Command::Firmware => (
            Workspace::new().and_then(|workspace| firmware::run(&workspace)),
            NOT_STARTED,
        ),
        Command::Bench { update } => (
            Workspace::new().and_then(|workspace| bench::run(&workspace, update)),
            NOT_STARTED,
        ),
        Command::Aarch64 => (
            Workspace::new().and_then(|workspace| aarch64::run(&workspace)),
            CHECK_FAILED,
        ),
        Command::C { update } => (
            Workspace::new().and_then(|workspace| c::run(&workspace, update)),
            NOT_STARTED,
        ),
        Command::Python => (
            Workspace::new().and_then(|workspace| wheel::run(&workspace)),
            CHECK_FAILED,
        ),
        Command::Web { update } => (
            Workspace::new().and_then(|workspace| web::run(&workspace, update)),
            CHECK_FAILED,
        ),
        Command::Docs => (
            Workspace::new().and_then(|workspace| site::run(&workspace)),
            CHECK_FAILED,
        ),
        Command::Supply { update } => (
            Workspace::new().and_then(|workspace| supply::run(&workspace, update)),
            CHECK_FAILED,
        ),
        Command::Coverage => (
            Workspace::new().and_then(|workspace| coverage::run(&workspace)),
            NOT_STARTED,
        ),
        Command::Mutants {
            files,
            shard,
            update,
        } => (
            Workspace::new().and_then(|workspace| {
                let options = mutants::Options {
                    files,
                    shard,
                    update,
                };
                mutants::run(&workspace, &options)
            }),
            NOT_STARTED,
        ),
        Command::Fuzz {
            targets,
            seconds,
            keep,
        } => (
            Workspace::new().and_then(|workspace| {
                let fuzzing = fuzz::Fuzzing { seconds, keep };
                fuzzing.run(&workspace, &targets)
            }),
            CHECK_FAILED,
        ),
        Command::Test { only, among_others } => (
            Workspace::new().and_then(|workspace| {
                let workspace = workspace.telling(!among_others);
                checks::run(&workspace, only)
            }),
            NOT_STARTED,
        ),
    };
    result.unwrap_or_else(|error| {
        eprintln!("xtask: {error:#}");
        ExitCode::from(code_of_error)
    })
}
