//! Options of the exposure.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fmc_camera_file::number::finite;

use super::ADVANCED;
use super::number::exposure_time;
use super::vh::VhOption;

/// The exposure and its correction.
#[derive(Debug, Args)]
pub struct ExposureArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// V/H, or ground speed and height.
    #[command(flatten)]
    pub vh: VhOption,
    /// Direction of flight; V/H is positive either way.
    #[arg(long, value_name = "DIRECTION", default_value = "forward", help_heading = ADVANCED)]
    pub direction: DirectionName,
    /// Exposure time, first light to last: seconds or a fraction such as 1/200.
    #[arg(long, value_name = "S", required = true, value_parser = exposure_time, allow_negative_numbers = true, allow_hyphen_values = true)]
    pub exposure: Option<f64>,
    /// Offset of the principal point from its calibrated place when the shutter opens, along the
    /// FMC axis, mm; overrides the planned run-up.
    #[arg(long, value_name = "MM", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub opening_offset_mm: Option<f64>,
    /// Detector out of its calibrated plane, positive away from the lens, µm; adds to the stage's
    /// run-out.
    #[arg(long, value_name = "UM", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub focus_shift_um: f64,
    /// Formula that turns a focus shift into distortion.
    #[arg(long, value_name = "SIGN", default_value = "physical", help_heading = ADVANCED)]
    pub focus_sign: FocusSignName,
    /// Model of the correction.
    #[arg(long, value_name = "MODEL", default_value = "exact", help_heading = ADVANCED)]
    pub model: ModelName,
}

/// Direction of flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DirectionName {
    /// Along the FMC axis.
    Forward,
    /// Against the FMC axis: a strip flown back, the camera not turned; travel and speed of the
    /// stage are negative.
    Reverse,
}

impl DirectionName {
    /// Returns the name that the command line uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Reverse => "reverse",
        }
    }
}

/// Formula that turns a focus shift into distortion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FocusSignName {
    /// A detector moved away from the lens enlarges the image by Δz/L, as ray tracing shows.
    Physical,
    /// Yuan et al. 2012, eqs. 14-17, as printed: k0' = -Δf/f.
    Printed,
}

/// Model of the correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelName {
    /// Exposure mean of the calibration about the moving principal point.
    Exact,
    /// The five coefficients of the camera file's table `fitted`.
    Fitted,
    /// Static calibration; motion and focus shift are ignored.
    Static,
}
