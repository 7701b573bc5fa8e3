//! Arguments of the calibration.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Subcommand, ValueEnum};
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::calibration::dlt3d::COEFFICIENT_NAMES;
use fmc_adjustment::grid::polynomial;

use super::number::positive;
use super::{ADVANCED, BundleArgs, RadiometryArgs, ResectionArgs, RigArgs, examples};

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
    /// Interior orientation and distortion from images of known object points.
    ///
    /// All images share them; each has its own position and attitude, which need no initial values
    /// where an image shows four known points or more.
    #[command(after_help = examples::CALIBRATE_RESECTION)]
    Resection(ResectionArgs),
    /// Interior orientation and distortion from images of points that several of them show.
    ///
    /// Self-calibrating bundle: object points are unknown, or control that is held or weighted, or
    /// check points, which have no influence. Positions and attitudes observed on board, scale bars
    /// and priors are observations besides.
    #[command(after_help = examples::CALIBRATE_BUNDLE)]
    Bundle(BundleArgs),
    /// 3-D direct linear transformation of one image of a spatial test field: principal distance,
    /// principal point, affinity, position, attitude and, on request, distortion.
    ///
    /// At least 6 points, not all but one of them in a plane. A thin field has a result whose σ
    /// says what it is worth. docs/calibration.md has the equations and how to photograph.
    #[command(after_help = examples::CALIBRATE_DLT3D)]
    Dlt3d(Dlt3dArgs),
    /// 2-D direct linear transformation of a plane target: a distortion table per focus setting.
    ///
    /// The table is complete only with its interior orientation, which is stated. The camera file
    /// keeps its principal distance and principal point, and receives a polynomial.
    /// docs/calibration.md has the equations and how to photograph.
    #[command(after_help = examples::CALIBRATE_DLT2D)]
    Dlt2d(Dlt2dArgs),
    /// Precise angles of a turntable, for one line of the sensor or for its area and stage:
    /// principal distance, principal point, distortion; scale, axis and run-out of the stage.
    ///
    /// The columns say which. For a line the formulas of Li et al. 2018, a direct fit and the exact
    /// model stand side by side; the exact model goes into the camera file. docs/calibration.md has
    /// the equations.
    #[command(after_help = examples::CALIBRATE_ANGLES)]
    Angles(AnglesArgs),
    /// Residual grid: what the polynomial leaves of a distortion table, as a cubic spline that the
    /// camera adds.
    ///
    /// Polynomial and grid are fitted together. The camera file names the files of the grids in its
    /// table `grid`. docs/calibration.md says how a distortion table is measured.
    #[command(after_help = examples::CALIBRATE_GRID)]
    Grid(GridArgs),
    /// Offset and gain of every pixel of a camera of several detectors, from flats and darks.
    ///
    /// Saturated samples are left out pixel by pixel; defective pixels are listed. Figures in the
    /// terms of EMVA 1288: gain, noise of reading, PRNU, DSNU. A non-uniformity of the source goes
    /// in unseen.
    #[command(after_help = examples::CALIBRATE_RADIOMETRY)]
    Radiometry(RadiometryArgs),
    /// Polynomials of the sub-images of a camera of several detectors, from control and ties.
    ///
    /// The orientations of the exposures are estimated, so that relief drops out and the
    /// polynomials are the camera's. What control cannot separate from the orientations stays
    /// nominal and is named.
    #[command(after_help = examples::CALIBRATE_RIG)]
    Rig(RigArgs),
}

/// Files that the methods share.
#[derive(Debug, Args)]
pub struct CalibrationFiles {
    /// Camera file (TOML): format, pixel, nominal principal distance; the rest is kept unless
    /// estimated.
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Folder for the calibrated camera file, summary.json, residuals.csv, covariance.csv, figures
    /// and certificate.html; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Day of the calibration, as it is printed on the page.
    #[arg(long, value_name = "YYYY-MM-DD", help_heading = ADVANCED)]
    pub date: Option<String>,
}

/// Options of the methods that look for gross errors.
#[derive(Debug, Args)]
pub struct CalibrationArgs {
    /// Files of every method.
    #[command(flatten)]
    pub files: CalibrationFiles,
    /// Reject no observation as a gross error.
    #[arg(long, help_heading = ADVANCED)]
    pub keep_all: bool,
}

/// Arguments of `calibrate dlt3d`.
#[derive(Debug, Args)]
pub struct Dlt3dArgs {
    /// CSV with a header, columns in any order: `point`, `x_mm,y_mm` (measured point, sensor
    /// frame) or `col_px,row_px`, `x_m,y_m,z_m` (object point); optional `sigma_um` or `sigma_px`.
    #[arg(value_name = "POINTS.csv")]
    pub points: PathBuf,
    /// Files and options of every method.
    #[command(flatten)]
    pub common: CalibrationArgs,
    /// Coefficients to estimate beside the eleven unknowns, of k1,k2,k3,p1,p2; the others are those
    /// of the camera file.
    #[arg(long, value_name = "LIST", default_value = "none")]
    pub estimate: Coefficients,
}

/// Arguments of `calibrate dlt2d`.
#[derive(Debug, Args)]
pub struct Dlt2dArgs {
    /// CSV with a header, columns in any order: `target`, `x_mm,y_mm` (measured point, sensor
    /// frame) or `col_px,row_px`, `x_m,y_m` (place in the plane); optional `focus` (a table each)
    /// and `sigma_um` or `sigma_px`.
    #[arg(value_name = "TARGETS.csv")]
    pub targets: PathBuf,
    /// Files and options of every method.
    #[command(flatten)]
    pub common: CalibrationArgs,
    /// Four targets at which the table is zero; without it the table is the least one, by all
    /// targets.
    #[arg(long, value_name = "A,B,C,D", value_delimiter = ',', num_args = 1)]
    pub corners: Option<Vec<String>>,
    /// States what the polynomial leaves of the table as a residual grid of the camera.
    #[arg(long, requires = "pitch_mm", help_heading = ADVANCED)]
    pub grid: bool,
    /// Distance of neighbouring nodes of the grid, mm: a tenth of the shortest wave leaves 0.4 % of
    /// it.
    #[arg(long, value_name = "MM", value_parser = positive, allow_negative_numbers = true, requires = "grid", help_heading = ADVANCED)]
    pub pitch_mm: Option<f64>,
    /// Part that carries the grid: lens, which moves with the principal point, or sensor. The table
    /// of one stage position does not tell them apart.
    #[arg(long, value_name = "PART", default_value = "lens", help_heading = ADVANCED)]
    pub frame: OneGridPart,
    /// Coefficients of the camera file's polynomial, of k1,k2,k3,p1,p2.
    #[arg(long, value_name = "LIST", default_value = "k1,k2,k3,p1,p2", help_heading = ADVANCED)]
    pub estimate: Coefficients,
}

/// Part of the camera that carries the structure of a table of one stage position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OneGridPart {
    /// The lens.
    Lens,
    /// The sensor.
    Sensor,
}

/// Arguments of `calibrate angles`.
#[derive(Debug, Args)]
pub struct AnglesArgs {
    /// CSV with a header, columns in any order. A line: `angle_deg` (of the turntable), `l_mm`
    /// (from the centre of the sensor); optional `band`, `repeat`. An area:
    /// `azimuth_deg,elevation_deg,x_mm,y_mm` (or `col_px,row_px`); optional `sigma_um` (or
    /// `sigma_px`) and `stage_offset_mm`, at two or more offsets, which calibrates the stage.
    #[arg(value_name = "ANGLES.csv")]
    pub angles: PathBuf,
    /// Files and options of every method.
    #[command(flatten)]
    pub common: CalibrationArgs,
    /// Interior unknowns of an area, separated by commas, or none: f, x0, y0, k1, k2, k3, p1, p2,
    /// b1, b2; without it all but b1, b2. The others are those of the camera file.
    #[arg(long, value_name = "NAMES", value_parser = interior, help_heading = ADVANCED)]
    pub estimate: Option<InteriorList>,
    /// Axis of the sensor frame along which the line lies; without it x.
    #[arg(long, value_name = "AXIS", help_heading = ADVANCED)]
    pub along: Option<AlongAxis>,
    /// σ of a place on the line, or of either coordinate of a point, µm; without it a tenth of a
    /// pixel.
    #[arg(long, value_name = "UM", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub sigma_l_um: Option<f64>,
    /// σ of an angle, seconds of arc.
    #[arg(long, value_name = "ARCSEC", default_value = "0.5", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub sigma_angle_arcsec: f64,
}

/// Arguments of `calibrate grid`.
#[derive(Debug, Args)]
pub struct GridArgs {
    /// CSV with a header, columns in any order: `x_mm,y_mm` (measured point, sensor frame) or
    /// `col_px,row_px`; `dx_um,dy_um` (distortion there, measured - ideal, about the interior
    /// orientation of the camera file); optional `stage_offset_mm`, without which it is 0.
    #[arg(value_name = "TABLE.csv")]
    pub table: PathBuf,
    /// Files of every method.
    #[command(flatten)]
    pub files: CalibrationFiles,
    /// Distance of neighbouring nodes, mm: a tenth of the shortest wave leaves 0.4 % of it.
    #[arg(long, value_name = "MM", value_parser = positive, allow_negative_numbers = true)]
    pub pitch_mm: f64,
    /// Part that carries the structure: that of the lens moves with the principal point. Both need
    /// a table of two stage offsets or more.
    #[arg(long, value_name = "PART", default_value = "lens", help_heading = ADVANCED)]
    pub frame: GridPart,
    /// Coefficients of the polynomial to estimate, of k0,k1,k2,k3,p1,p2,b1,b2, or none; the others
    /// are those of the camera file.
    #[arg(long, value_name = "LIST", default_value = "k0,k1,k2,k3,p1,p2", help_heading = ADVANCED)]
    pub estimate: PolynomialList,
}

/// Part of the camera that carries a structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GridPart {
    /// The lens.
    Lens,
    /// The sensor.
    Sensor,
    /// A grid each.
    Both,
}

/// Coefficients of the polynomial to estimate: K0 to K3, P1, P2, B1, B2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PolynomialList(pub [bool; polynomial::COEFFICIENTS]);

impl FromStr for PolynomialList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(Self(chosen(text, &polynomial::COEFFICIENT_NAMES, &[])?))
    }
}

/// Interior unknowns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InteriorList(pub Vec<InteriorElement>);

impl Default for InteriorList {
    fn default() -> Self {
        let is_affinity =
            |one: &InteriorElement| matches!(one, InteriorElement::B1 | InteriorElement::B2);
        let all = InteriorElement::ALL.into_iter();
        Self(all.filter(|one| !is_affinity(one)).collect())
    }
}

fn interior(text: &str) -> Result<InteriorList, String> {
    let mut list = Vec::new();
    if text.trim() == "none" {
        return Ok(InteriorList(list));
    }
    for name in text.split(',').map(str::trim) {
        let element = InteriorElement::from_symbol(name)
            .ok_or_else(|| format!("{name} is none of f, x0, y0, k1, k2, k3, p1, p2, b1, b2"))?;
        if list.contains(&element) {
            return Err(format!("{name} appears twice"));
        }
        list.push(element);
    }
    Ok(InteriorList(list))
}

/// Axis of the sensor frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AlongAxis {
    /// x, to the right.
    X,
    /// y, upwards.
    Y,
}

/// Coefficients to estimate: K1, K2, K3, P1, P2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Coefficients(pub [bool; 5]);

impl FromStr for Coefficients {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // The eleven unknowns are always estimated.
        let always = ["f", "x0", "y0", "b1", "b2"];
        Ok(Self(chosen(text, &COEFFICIENT_NAMES, &always)?))
    }
}

/// Reads a list of names, separated by commas, or `none`; those of `ignored` choose nothing.
fn chosen<const N: usize>(
    text: &str,
    names: &[&str; N],
    ignored: &[&str],
) -> Result<[bool; N], String> {
    let mut chosen = [false; N];
    if text == "none" {
        return Ok(chosen);
    }
    for name in text.split(',').map(str::trim) {
        if ignored.contains(&name) {
            continue;
        }
        let place = names.iter().position(|one| *one == name);
        match place.and_then(|index| chosen.get_mut(index)) {
            Some(flag) => *flag = true,
            None => {
                return Err(format!(
                    "\"{name}\" is none of {}; several are separated by commas, none is \"none\"",
                    names.join(", ")
                ));
            }
        }
    }
    Ok(chosen)
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
