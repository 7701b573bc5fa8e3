//! Arguments of simulated blocks.

use std::path::PathBuf;

use clap::Args;

use super::ADVANCED;

/// Arguments of `block`.
#[derive(Debug, Args)]
pub struct SimulatedBlockArgs {
    /// Scenario (TOML); host-sim/scenarios/block holds six, ixm-50.toml with every key explained.
    #[arg(long, value_name = "FILE")]
    pub scenario: PathBuf,
    /// Number of runs, each with other errors, 2 to 10000.
    #[arg(long, value_name = "N", default_value = "20", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub runs: u32,
    /// Seed of all runs, a whole number: the same seed gives the same files, on any number of
    /// cores.
    #[arg(long, value_name = "N", default_value = "1", help_heading = ADVANCED)]
    pub seed: u64,
    /// Folder for report.html, summary.json, runs.csv and the figure (check-points.svg); made if it
    /// does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
