//! The `host-sim` command.

use std::process::ExitCode;

use clap::Parser;
use host_sim::{cli::Cli, command, failure};

fn main() -> ExitCode {
    failure::print_plainly();
    match command::run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
