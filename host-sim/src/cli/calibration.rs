//! Arguments of the calibration.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::{ADVANCED, examples};

/// Arguments of `calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// Method of calibration.
    #[command(subcommand)]
    pub method: CalibrationMethod,
}

/// Methods of calibration.
#[derive(Debug, Subcommand)]
pub enum CalibrationMethod {
    /// The five-coefficient model, by robust least squares of observed distortions.
    #[command(after_help = examples::CALIBRATE_FIVE)]
    Five(FiveArgs),
}

/// Arguments of `calibrate five`.
#[derive(Debug, Args)]
pub struct FiveArgs {
    /// CSV with a header, columns in any order: `x_mm,y_mm` (measured point, sensor frame),
    /// `dx_um,dy_um` (total distortion, measured - ideal), `vh_per_s,exposure_s,opening_offset_mm`;
    /// optional `sigma_um` (of dx and of dy; without it all weigh the same) and `id`.
    #[arg(value_name = "OBSERVATIONS.csv")]
    pub observations: PathBuf,
    /// Camera file (TOML): its K3, P, B, principal point and axis are taken as known.
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Folder for the camera file with its table `fitted`, residuals.csv, summary.json and figures;
    /// made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Impose `K_d1` = 2 `P_m1`.
    #[arg(long, help_heading = ADVANCED)]
    pub tie: bool,
    /// Quantity that multiplies `K_d1` and `P_m1`: the travel δ, or the offset c̄ of the exposure
    /// centroid, which is right where Δδ/δ varies.
    #[arg(long, value_name = "WHAT", default_value = "travel", help_heading = ADVANCED)]
    pub regress_on: RegressOn,
    /// Treatment of the static decentring along the FMC axis (P2 for ±y, P1 for ±x), which one
    /// exposure cannot tell from `K_d1` and `P_m1`.
    #[arg(long, value_name = "HOW", default_value = "hold", help_heading = ADVANCED)]
    pub static_p2: StaticP2,
}

/// Quantity that multiplies `K_d1` and `P_m1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RegressOn {
    /// δ, the travel while the shutter is open.
    Travel,
    /// c̄, the offset of the exposure centroid.
    Centroid,
}

/// Treatment of the static decentring along the FMC axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StaticP2 {
    /// Held; the observations must be able to separate it from the dynamic terms.
    Hold,
    /// Estimated, and written to the table `distortion`.
    Estimate,
    /// Held and taken as free of error: one exposure suffices.
    Known,
}
