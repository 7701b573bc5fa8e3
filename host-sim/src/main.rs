//! The `host-sim` command.

use std::process::ExitCode;

use clap::Parser;
use fmc_output::part;
use host_sim::{cli::Cli, command, failure};

fn main() -> ExitCode {
    failure::print_plainly();
    part::remove_on_signals();
    match command::run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
