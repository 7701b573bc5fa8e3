//! Arguments of statistics over random missions.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::ADVANCED;

/// Arguments of `statistics`.
#[derive(Debug, Args)]
pub struct StatisticsArgs {
    /// Number of missions, 1 to 100000.
    #[arg(long, value_name = "N", default_value = "200", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub missions: u32,
    /// Seed of all missions, a whole number: the same seed gives the same files, on any number of
    /// cores.
    #[arg(long, value_name = "N", default_value = "1", help_heading = ADVANCED)]
    pub seed: u64,
    /// Number of faults that each mission has, at random moments and in random sizes.
    #[arg(long, value_name = "NUMBER", default_value = "none")]
    pub faults: FaultNumber,
    /// Folder for report.html, summary.json, missions.csv, the figures and the scenarios that
    /// repeat the worst cases; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Number of faults of a mission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FaultNumber {
    /// No fault: nothing may go wrong.
    None,
    /// One fault.
    One,
    /// Two faults, which may be active together.
    Two,
}

impl FaultNumber {
    /// Returns the number.
    #[must_use]
    pub const fn number(self) -> u32 {
        match self {
            Self::None => 0,
            Self::One => 1,
            Self::Two => 2,
        }
    }
}
