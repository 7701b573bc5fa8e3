//! Arguments of missions and their records.

use std::path::PathBuf;

use clap::Args;

use super::{ADVANCED, DeviceArgs};

/// Arguments of `mission`.
#[derive(Debug, Args)]
pub struct MissionArgs {
    /// Scenario (TOML); host-sim/scenarios/mission.toml explains every key,
    /// host-sim/scenarios/faults has one for each fault. Without it the nominal mission of 1000
    /// exposures.
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Settings of the camera (TOML), the file of `camera prepare`, in place of those that follow
    /// from the scenario's hardware; what the scenario says of its hardware may not contradict
    /// them.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub settings: Option<PathBuf>,
    /// Number of exposures in place of the scenario's, 1 to 100000.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub exposures: Option<u32>,
    /// Seed of air, noise, jitter and encoder phase, a whole number: the same seed gives the same
    /// files. Without it the scenario's, or 1.
    #[arg(long, value_name = "N", help_heading = ADVANCED)]
    pub seed: Option<u64>,
    /// Trigger whose frame is shown millisecond by millisecond; without it the first with a fault,
    /// or else the one with the largest smear.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = ADVANCED)]
    pub frame: Option<u32>,
    /// Folder for report.html, records.csv, records.json, truth.csv, summary.json and figures; made
    /// if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Device on which the camera runs.
    #[command(flatten, next_help_heading = ADVANCED)]
    pub device: DeviceArgs,
}

/// Arguments of `records`.
#[derive(Debug, Args)]
pub struct RecordsArgs {
    /// Device on which the camera runs.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Folder for records.csv and records.json; made if it does not exist. Records that are there
    /// already are not replaced.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Go on while the camera flies: fetch each record as soon as its frame is finished, and print
    /// a line. Ends with Ctrl-C, where the link is cut, and where the camera is prepared again.
    ///
    /// records.csv has a whole row of every record fetched, at any time; the camera forgets a
    /// record once its row is on the disk. records.json comes at the end.
    #[arg(long)]
    pub follow: bool,
    /// Folder of records fetched earlier in this flight; may be given several times. records.csv
    /// alone will do. Records that are there are not written again.
    ///
    /// If the index mark has shown since then that the encoder was wrong in some of these
    /// exposures, their records get flag, fault and σ, as the camera does with those that it still
    /// has.
    #[arg(long, value_name = "DIR", help_heading = ADVANCED)]
    pub earlier: Vec<PathBuf>,
}
