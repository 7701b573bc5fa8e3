//! A camera on a board, from the PC.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use fmc_camera_file::number::finite;

use super::number::{between, exposure_time};
use super::{DeviceArgs, DirectionName};

/// Arguments of `camera`.
#[derive(Debug, Args)]
pub struct CameraArgs {
    /// Where the camera is.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// What it is to do.
    #[command(subcommand)]
    pub action: CameraAction,
}

/// What a camera on a board can be asked for.
#[derive(Debug, Subcommand)]
pub enum CameraAction {
    /// Give it calibration and settings: it is in standby then.
    ///
    /// Records of a flight before that have not been fetched (`host-sim records`) are not lost: it refuses.
    Prepare(PrepareArgs),
    /// Obey triggers: strokes to and fro, then ready. Waits until it is.
    Arm,
    /// Refuse triggers, and leave the stage alone. An exposure under way is finished.
    Disarm,
    /// A fault has been looked at: to standby.
    ClearFault,
    /// The stage stands at its calibrated position: the encoder counts from there. In standby alone.
    Referenced,
    /// Exposure time of the frames to come.
    Exposure(ExposureTimeArgs),
    /// V/H, ground speed over height above ground.
    ///
    /// The camera believes it for 5 s; with --for it is told again until then.
    Vh(VhArgs),
    /// What it is doing.
    Status(StatusArgs),
}

/// Arguments of `camera prepare`.
#[derive(Debug, Args)]
pub struct PrepareArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Settings of the flight (TOML): those of docs/integration.md, section 3, by their names there; the others stay as
    /// they are by default.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    /// Which way the camera flies; without it as the settings say, or forward.
    #[arg(long, value_name = "DIRECTION")]
    pub direction: Option<DirectionName>,
}

/// Arguments of `camera exposure`.
#[derive(Debug, Args)]
pub struct ExposureTimeArgs {
    /// First light to last: seconds or a fraction such as 1/200, within the limits of the camera file.
    #[arg(value_name = "S", value_parser = exposure_time, allow_hyphen_values = true)]
    pub exposure: f64,
}

/// Arguments of `camera vh`.
#[derive(Debug, Args)]
pub struct VhArgs {
    /// V/H, 1/s.
    #[arg(value_name = "PER_S", value_parser = finite, allow_negative_numbers = true)]
    pub vh: f64,
    /// For so long, s; without it once.
    #[arg(long = "for", value_name = "S", value_parser = between(0.0, 86_400.0), default_value = "0", allow_negative_numbers = true)]
    pub for_s: f64,
}

/// Arguments of `camera status`.
#[derive(Debug, Args)]
pub struct StatusArgs {
    /// For machines.
    #[arg(long)]
    pub json: bool,
}
