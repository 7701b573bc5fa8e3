//! Arguments of the frames of a flight.

use std::path::PathBuf;

use clap::{Arg, ArgGroup, Args, ValueEnum};

use crate::formats::frame_points::ListProgram;

/// Heading of the options for the frames of a flight.
pub(super) const FRAMES: &str = "Frames of a flight";

/// The frames of a flight, in place of one exposure.
#[derive(Debug, Args)]
#[group(skip)]
#[command(
    next_help_heading = FRAMES,
    group = ArgGroup::new("frame_source").args(["records", "frames"]),
    group = ArgGroup::new("frames_or_vh")
        .args(["vh", "ground_speed", "records", "frames"])
        .multiple(true)
        .required(true)
)]
pub struct FramesArgs {
    /// Frames of the records of a flight, records.csv or records.json. The records say everything
    /// of the exposures; they must be of the calibration of --camera.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "frames", "vh", "ground_speed", "height", "exposure", "opening_offset_mm",
            "focus_shift_um", "focus_sign", "model", "direction",
        ]
    )]
    pub records: Option<PathBuf>,
    /// Frames of a table, where no camera flew: CSV with a row for each exposure and the columns
    /// `sequence`, `frame` or `image`, and by the names of the options `vh` or `ground_speed` and
    /// `height`, `exposure`, `opening_offset_mm`, `focus_shift_um`, `direction`, `focus_sign`,
    /// `model`. The options hold for what it leaves out.
    #[arg(long, value_name = "TABLE.csv")]
    pub frames: Option<PathBuf>,
    /// Names of the images: CSV with the columns `sequence` and `image`.
    #[arg(
        long,
        value_name = "MAP.csv",
        alias = "image",
        requires = "frame_source"
    )]
    pub images: Option<PathBuf>,
}

impl FramesArgs {
    /// Returns `true` if frames of a flight are asked for.
    #[must_use]
    pub const fn are_given(&self) -> bool {
        self.records.is_some() || self.frames.is_some()
    }
}

/// Answers for points of many frames.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = FRAMES)]
pub struct FrameAnswerArgs {
    /// Coordinates that `correct` answers with and that `distort` takes. With the last two one
    /// camera serves all frames.
    #[arg(
        long,
        value_name = "ANSWER",
        default_value = "ideal",
        requires = "frame_source"
    )]
    pub answer: AnswerName,
    /// Write the coordinates as the list of images of another program in place of the points' own
    /// format: of points in CSV with a column `point` or `id`, for `correct` with --answer
    /// ideal-shifted or measured-shifted.
    #[arg(long, value_name = "PROGRAM", requires = "frame_source")]
    pub list: Option<ListProgram>,
    /// σ and correlations of the calibration, for σ of the coordinates: JSON with `parameters`,
    /// `sigma` and `correlations`, as `import` writes it, in the symbols and units of the camera
    /// file (x0, y0, k0 to k3, p1, p2, b1, b2), or in those of Metashape (f, cx, cy and so on).
    #[arg(long, value_name = "FILE", requires = "frame_source")]
    pub uncertainty: Option<PathBuf>,
    /// Treatment of a point that has no answer: off the sensor, or of a refused trigger.
    #[arg(
        long,
        value_name = "ACTION",
        default_value = "error",
        requires = "frame_source"
    )]
    pub off_sensor: OffSensorName,
}

/// Coordinates of points of many frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AnswerName {
    /// Without distortion, about the principal point of the frame.
    Ideal,
    /// Without distortion, about the calibrated principal point: for one camera without
    /// distortion.
    IdealShifted,
    /// With the distortion of the calibration, about the calibrated principal point and at the
    /// calibrated principal distance: for the calibrated camera, or one that is self-calibrated.
    MeasuredShifted,
}

/// Treatment of a point without an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OffSensorName {
    /// The command fails with the first of them.
    Error,
    /// It is left out.
    Skip,
    /// It has no coordinates, and the column `flag` says why.
    Flag,
}

/// Makes an option of an exposure one that frames stand for.
pub(super) fn optional_with_frames(arg: Arg) -> Arg {
    arg.required(false)
        .required_unless_present_any(["records", "frames"])
}

/// Makes a group one that frames stand for.
pub(super) fn optional_group(group: ArgGroup) -> ArgGroup {
    group.required(false)
}
