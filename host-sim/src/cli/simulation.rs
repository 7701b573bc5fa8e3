//! Arguments of simulations and of the error budget.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fmc_camera_file::number::finite;
use fmc_simulation::budget::assumptions::{
    DRIFT_DEG, ENCODER_UM, FOCUS_UM, HEIGHT_M, Quantity, RATE_DEG_S, RELIEF_PERCENT, TIMING_MS,
    VH_ERROR_PERCENT,
};

use super::calibration::RegressOn;
use super::number::{between, exposure_time};
use super::{ADVANCED, FocusSignName, ReadingName, VhOption, WeightName};

/// Arguments of `smear`.
#[derive(Debug, Args)]
pub struct SmearArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// True V/H over the reference plane, or ground speed and height.
    #[command(flatten)]
    pub vh: VhOption,
    /// Exposure time, first light to last: seconds or a fraction such as 1/200.
    #[arg(long, value_name = "S", value_parser = exposure_time, allow_negative_numbers = true, allow_hyphen_values = true)]
    pub exposure: f64,
    /// Excess of the V/H that the camera compensates over the true V/H, per cent; -50 to 50.
    #[arg(long, value_name = "PERCENT", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub vh_error_percent: f64,
    /// Terrain above the reference plane, per cent of the height; -100 to 90.
    #[arg(long, value_name = "PERCENT", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub relief_percent: f64,
    /// Optical axis forward of the vertical, degrees; -45 to 45.
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub pitch_deg: f64,
    /// Optical axis to the left of the vertical, degrees; -45 to 45.
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub roll_deg: f64,
    /// Track to the right of the FMC axis, degrees; -45 to 45.
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub drift_deg: f64,
    /// Rate about the axis to the right, nose up, degrees per second; -60 to 60.
    #[arg(long, value_name = "DEG_S", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub pitch_rate_deg_s: f64,
    /// Rate about the FMC axis, right side down, degrees per second; -60 to 60.
    #[arg(long, value_name = "DEG_S", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub roll_rate_deg_s: f64,
    /// Rate about the axis upwards, nose to the left, degrees per second; -60 to 60.
    #[arg(long, value_name = "DEG_S", default_value = "0", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub yaw_rate_deg_s: f64,
    /// Folder for smear.csv, summary.json and the arrow fields; made if it does not exist.
    #[arg(long, value_name = "DIR", help_heading = ADVANCED)]
    pub out: Option<PathBuf>,
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Camera file (TOML); its limits must hold V/H 0.05 to 0.17 1/s and 1/700 to 1/100 s.
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Standard deviation of the Gaussian noise on dx and on dy, µm, 0 to 1000.
    #[arg(long, value_name = "UM", default_value = "0.85", value_parser = between(0.0, 1000.0), allow_negative_numbers = true)]
    pub noise_um: f64,
    /// Detector out of its calibrated plane in every exposure, positive away from the lens, µm;
    /// adds to the stage's run-out.
    #[arg(long, value_name = "UM", default_value = "6", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub focus_shift_um: f64,
    /// Formula that turns a focus shift into distortion.
    #[arg(long, value_name = "SIGN", default_value = "physical", help_heading = ADVANCED)]
    pub focus_sign: FocusSignName,
    /// Seed of the noise, a whole number: the same seed gives the same files.
    #[arg(
        long,
        value_name = "N",
        default_value = "1",
        allow_negative_numbers = true,
        help_heading = ADVANCED
    )]
    pub seed: u64,
    /// Weight of the mean over the exposure: the light, or the arc length of the distortion
    /// hodograph as printed in eqs. 10-11.
    #[arg(long, value_name = "WEIGHT", default_value = "exposure", help_heading = ADVANCED)]
    pub weight: WeightName,
    /// Reading of eqs. 12-13: as changes (consistent), or literally, which counts the static
    /// distortion twice.
    #[arg(long, value_name = "READING", default_value = "consistent", help_heading = ADVANCED)]
    pub reading: ReadingName,
    /// Impose `K_d1` = 2 `P_m1`, as a lens of K1 alone requires.
    #[arg(long, help_heading = ADVANCED)]
    pub tie: bool,
    /// Quantity that multiplies `K_d1` and `P_m1`.
    #[arg(long, value_name = "WHAT", default_value = "travel", help_heading = ADVANCED)]
    pub regress_on: RegressOn,
    /// Strategy of the run-up, in place of that of the camera file.
    #[arg(long, value_name = "STRATEGY", help_heading = ADVANCED)]
    pub strategy: Option<StrategyName>,
    /// Folder for report.html, summary.json, coefficients.csv and the figure (coefficients.svg,
    /// coefficients.png); made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Strategy of the run-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StrategyName {
    /// The run-up starts early, so that the exposure centroid falls on the calibrated position.
    Centred,
    /// The stage starts at the calibrated position and has left it when the shutter opens.
    FromRest,
}

/// Arguments of `budget`.
#[derive(Debug, Args)]
pub struct BudgetArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Height above the ground, m, 10 to 20000.
    #[arg(long, value_name = "M", default_value_t = HEIGHT_M.usual, value_parser = within(HEIGHT_M), allow_negative_numbers = true)]
    pub height_m: f64,
    /// Focus shift that was not measured, µm, 0 to 100; in addition to the stage's run-out.
    #[arg(long, value_name = "UM", default_value_t = FOCUS_UM.usual, value_parser = within(FOCUS_UM), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub focus_um: f64,
    /// Error of V/H, %, 0 to 50.
    #[arg(long, value_name = "PERCENT", default_value_t = VH_ERROR_PERCENT.usual, value_parser = within(VH_ERROR_PERCENT), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub vh_error_percent: f64,
    /// Terrain above the height that V/H holds for, % of it, 0 to 50.
    #[arg(long, value_name = "PERCENT", default_value_t = RELIEF_PERCENT.usual, value_parser = within(RELIEF_PERCENT), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub relief_percent: f64,
    /// Drift angle that is not compensated, degrees, 0 to 45.
    #[arg(long, value_name = "DEG", default_value_t = DRIFT_DEG.usual, value_parser = within(DRIFT_DEG), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub drift_deg: f64,
    /// Rate of roll, of pitch and of yaw that the mount leaves, degrees per second, 0 to 60.
    #[arg(long, value_name = "DEG_PER_S", default_value_t = RATE_DEG_S.usual, value_parser = within(RATE_DEG_S), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub rate_deg_s: f64,
    /// Step of the stage's encoder, µm, 0 to 100.
    #[arg(long, value_name = "UM", default_value_t = ENCODER_UM.usual, value_parser = within(ENCODER_UM), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub encoder_um: f64,
    /// Error of the time stamp against position and attitude, ms, 0 to 100.
    #[arg(long, value_name = "MS", default_value_t = TIMING_MS.usual, value_parser = within(TIMING_MS), allow_negative_numbers = true, help_heading = ADVANCED)]
    pub timing_ms: f64,
    /// Folder for report.html, summary.json and the figure (budget.svg, budget.png); made if it
    /// does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Returns a reader of numbers that a quantity may have.
fn within(
    Quantity { least, most, .. }: Quantity,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    between(least, most)
}

/// Arguments of `strip`.
#[derive(Debug, Args)]
pub struct StripArgs {
    /// Scenario (TOML); host-sim/scenarios holds two, with every key explained.
    #[arg(long, value_name = "FILE")]
    pub scenario: PathBuf,
    /// Seed of the noise, a whole number: the same seed gives the same files.
    #[arg(long, value_name = "N", default_value = "1", help_heading = ADVANCED)]
    pub seed: u64,
    /// Number of repetitions of the experiment, each with other errors, 2 to 10000.
    #[arg(long, value_name = "N", default_value = "100", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub repetitions: u32,
    /// Folder for report.html, summary.json, repetitions.csv and figures; made if it does not
    /// exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}
