//! Arguments of a campaign of faults.

use std::path::PathBuf;

use clap::Args;
use fmc_simulation::mission::fault::InjectedFault;

use super::ADVANCED;

/// Arguments of `campaign`.
#[derive(Debug, Args)]
pub struct CampaignArgs {
    /// Folder for report.html, summary.json, runs.csv, heat-map.csv, the scenarios that repeat
    /// findings, and progress.txt, from which a campaign that was ended goes on; made if it does
    /// not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// A twentieth of the runs and of the pairs, which the seed selects.
    #[arg(long)]
    pub quick: bool,
    /// Number of pairs of faults, 0 to 10000000.
    #[arg(long, value_name = "N", default_value = "100000", value_parser = clap::value_parser!(u32).range(0..=10_000_000), help_heading = ADVANCED)]
    pub pairs: u32,
    /// A fault by its name in scenarios, such as counts-lost; a wrong name lists all of them. May
    /// be repeated. Default: all of them.
    #[arg(long, value_name = "NAME", value_parser = fault)]
    pub fault: Vec<InjectedFault>,
    /// Seed of the world, of the pairs and of what --quick selects, 0 to 2147483647: the same seed
    /// gives the same files, on any number of cores.
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u64).range(0..=2_147_483_647), help_heading = ADVANCED)]
    pub seed: u64,
    /// Part of what its record allows beyond which an exposure counts as silently bad, 0.1 to 1:
    /// with less than 1 the findings are those that come closest to it.
    #[arg(long, value_name = "PART", default_value = "1", value_parser = allowed, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub allowed: f64,
}

/// Reads a part of what a record allows.
fn allowed(text: &str) -> Result<f64, String> {
    let part = text.parse().ok();
    part.filter(|part| (0.1..=1.0).contains(part))
        .ok_or_else(|| "is not a number from 0.1 to 1".to_owned())
}

/// Reads the name of a fault.
fn fault(name: &str) -> Result<InjectedFault, String> {
    InjectedFault::named(name).ok_or_else(|| {
        let known = InjectedFault::ALL.map(InjectedFault::name).join(", ");
        format!("is not a fault; there are {known}")
    })
}
