//! Options of the commands for points and frames.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::exposure::ExposureArgs;
use super::frames::{FrameAnswerArgs, FramesArgs, optional_group, optional_with_frames};
use super::trajectory::{TrajectoryArgs, needs_frames};
use super::{ADVANCED, DeviceArgs};
use crate::formats::points::PointFormat;

/// Arguments of `correct` and `distort`.
#[derive(Debug, Args)]
#[command(
    mut_arg("exposure", optional_with_frames),
    mut_arg("trajectory", needs_frames),
    mut_group("vh_or_speed", optional_group)
)]
pub struct PointsArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// The frames of a flight in place of one exposure.
    #[command(flatten)]
    pub frames: FramesArgs,
    /// Answers for points of many frames.
    #[command(flatten)]
    pub answers: FrameAnswerArgs,
    /// The trajectory of the flight.
    #[command(flatten)]
    pub trajectory: TrajectoryArgs,
    /// Device on which the camera runs.
    #[command(flatten, next_help_heading = ADVANCED)]
    pub device: DeviceArgs,
    /// Files of points and answers.
    #[command(flatten)]
    pub files: PointFiles,
}

/// Files of points and answers.
#[derive(Debug, Args)]
pub struct PointFiles {
    /// CSV with a header, columns in any order: `id,x_mm,y_mm` (sensor frame) or
    /// `id,col_px,row_px`. Or an array of NumPy (.npy), N rows of `x_mm`, `y_mm`, answered by N
    /// rows of `x_mm`, `y_mm`, `dx_um`, `dy_um`. `-` reads standard input. Points of many frames
    /// have a column `sequence`, `frame` or `image`, and may be Parquet (docs/formats.md).
    #[arg(value_name = "POINTS.csv")]
    pub points: PathBuf,
    /// Answer file; it appears only when it is complete. Without it standard output, where the
    /// answers before a wrong point in a long file may already have been written: the exit code
    /// reports the failure.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub out: Option<PathBuf>,
    /// Format of points and answers whose file name has no extension of a format; without it
    /// CSV for the points, and for the answers the format of the points.
    #[arg(long, value_name = "FORMAT", help_heading = ADVANCED)]
    pub format: Option<PointFormat>,
}

/// Arguments of `reference`.
#[derive(Debug, Args)]
pub struct ReferenceArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// Weight of the mean over the exposure: the light, or the arc length of the distortion
    /// hodograph as printed in eqs. 10-11.
    #[arg(long, value_name = "WEIGHT", default_value = "exposure", help_heading = ADVANCED)]
    pub weight: WeightName,
    /// Reading of eqs. 12-13: as changes (consistent), or literally, which counts the static
    /// distortion twice.
    #[arg(long, value_name = "READING", default_value = "consistent", help_heading = ADVANCED)]
    pub reading: ReadingName,
    /// Files of points and answers.
    #[command(flatten)]
    pub files: PointFiles,
}

/// Arguments of `frame`.
#[derive(Debug, Args)]
#[command(
    mut_arg("exposure", optional_with_frames),
    mut_arg("trajectory", needs_frames),
    mut_group("vh_or_speed", optional_group)
)]
pub struct FrameArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// The frames of a flight in place of one exposure.
    #[command(flatten)]
    pub frames: FramesArgs,
    /// The trajectory of the flight.
    #[command(flatten)]
    pub trajectory: TrajectoryArgs,
    /// Device on which the camera runs.
    #[command(flatten, next_help_heading = ADVANCED)]
    pub device: DeviceArgs,
    /// Print JSON.
    #[arg(long, help_heading = ADVANCED)]
    pub json: bool,
    /// Answer file; without it standard output.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub out: Option<PathBuf>,
}

/// Weight of the mean over the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WeightName {
    /// The light, which the sensor integrates.
    Exposure,
    /// Arc length of the distortion hodograph, eqs. 10-11.
    ArcLength,
}

/// Reading of eqs. 12-13.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReadingName {
    /// The two terms are changes of the distortion.
    Consistent,
    /// The two terms are totals, as printed.
    Literal,
}
