//! Arguments of the calibrations by a network of images.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::solution::DatumChoice;
use fmc_adjustment::bundle::stage::StageElement;

use super::{ADVANCED, CalibrationArgs};

/// Arguments that `calibrate resection` and `calibrate bundle` share.
#[derive(Debug, Args)]
pub struct NetworkArgs {
    /// CSV with a header, columns in any order: `image,point,x_mm,y_mm` (measured point, sensor
    /// frame) and optional `sigma_um`; or `image,point,col_px,row_px` and optional `sigma_px`.
    #[arg(value_name = "IMAGE_POINTS.csv")]
    pub image_points: PathBuf,
    /// Object points: `point,x_m,y_m,z_m,role` and optional `sigma_x_m,sigma_y_m,sigma_z_m`; role
    /// control, check or approximate, σ 0 or none: held.
    #[arg(long, value_name = "FILE")]
    pub points: PathBuf,
    /// Options that all methods share.
    #[command(flatten)]
    pub common: CalibrationArgs,
    /// Positions and attitudes: `image,x_m,y_m,z_m,pitch_deg,roll_deg,yaw_deg`, optional σ
    /// (`sigma_x_m` to `sigma_yaw_deg`; none: initial value), `vx_m_s,vy_m_s,vz_m_s` and `strip`.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub images: Option<PathBuf>,
    /// Shared unknowns, separated by commas, or none: f, x0, y0, k1, k2, k3, p1, p2, b1, b2;
    /// `time_offset`, `lever_arm`, boresight and shift (of every strip) of observed positions and
    /// attitudes; `stage_scale`, `stage_axis_angle` and `run_out` of the stage, with --records.
    #[arg(
        long,
        value_name = "NAMES",
        default_value = "f,x0,y0,k1,k2,k3,p1,p2",
        value_parser = estimated,
        help_heading = ADVANCED
    )]
    pub estimate: ParameterList,
    /// σ with which initial values are observations, as f=0.005,x0=0.01: mm for f, x0, y0, the
    /// unit of the coefficient, s, m or rad for others; without unit for scale and run-out.
    #[arg(long, value_name = "NAME=SIGMA,…", value_parser = priors, help_heading = ADVANCED)]
    pub prior: Option<PriorList>,
    /// Datum: by observations where they suffice, by inner constraints over all object points, or
    /// by observations alone.
    #[arg(long, value_name = "HOW", default_value = "auto", help_heading = ADVANCED)]
    pub datum: DatumName,
}

/// Arguments of `calibrate resection`.
#[derive(Debug, Args)]
pub struct ResectionArgs {
    /// The network.
    #[command(flatten)]
    pub network: NetworkArgs,
}

/// Arguments of `calibrate bundle`.
#[derive(Debug, Args)]
pub struct BundleArgs {
    /// The network.
    #[command(flatten)]
    pub network: NetworkArgs,
    /// Scale bars: `point_a,point_b,length_m,sigma_m`.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub scale_bars: Option<PathBuf>,
    /// The camera's records.csv: every image, named by its sequence, with the principal point and
    /// the focus shift of its own exposure. Image points are as measured, not corrected.
    #[arg(long, value_name = "records.csv", help_heading = ADVANCED)]
    pub records: Option<PathBuf>,
    /// Positions of --images are those at the triggers: each is moved by its velocity times the
    /// centroid of the exposure less the trigger, by the records.
    #[arg(long, requires = "records", requires = "images", help_heading = ADVANCED)]
    pub positions_at_trigger: bool,
    /// Hand the result over to programs that know one camera without distortion: corrected image
    /// points, poses, object points; colmap, csv, or both with a comma between. Goes with --out.
    #[arg(
        long,
        value_name = "FORMAT",
        value_delimiter = ',',
        num_args = 1,
        requires = "out",
        help_heading = ADVANCED
    )]
    pub export: Vec<HandOverFormat>,
}

/// Format in which a bundle is handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HandOverFormat {
    /// COLMAP text: cameras.txt, images.txt, points3D.txt.
    Colmap,
    /// `corrected_points.csv`, `orientations.csv`, `pinhole.csv`.
    Csv,
}

/// Choice of the observations or constraints that determine the datum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DatumName {
    /// Observations where they suffice.
    Auto,
    /// Inner constraints over all object points.
    Free,
    /// Observations alone; an error where they do not suffice.
    Held,
}

impl From<DatumName> for DatumChoice {
    fn from(name: DatumName) -> Self {
        match name {
            DatumName::Auto => Self::Auto,
            DatumName::Free => Self::Free,
            DatumName::Held => Self::Held,
        }
    }
}

/// Shared unknowns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterList(Vec<Parameter>);

/// σ of shared unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorList(Vec<(Parameter, f64)>);

impl NetworkArgs {
    /// Shared unknowns with their priors.
    #[must_use]
    pub fn unknowns(&self) -> Unknowns {
        Unknowns {
            estimated: self.estimate.0.clone(),
            priors: self
                .prior
                .as_ref()
                .map_or_else(Vec::new, |list| list.0.clone()),
        }
    }
}

/// Returns the unknowns of a name; three for a vector.
fn parameters(name: &str) -> Result<Vec<Parameter>, String> {
    match name {
        "time_offset" => Ok(vec![Parameter::TimeOffset]),
        "lever_arm" => Ok((0..3).map(Parameter::LeverArm).collect()),
        "boresight" => Ok((0..3).map(Parameter::Boresight).collect()),
        // One stands for those of all strips and axes.
        "shift" => Ok(vec![Parameter::Shift { strip: 0, axis: 0 }]),
        _ => InteriorElement::from_symbol(name)
            .map(Parameter::Interior)
            .or_else(|| StageElement::from_symbol(name).map(Parameter::Stage))
            .map(|parameter| vec![parameter])
            .ok_or_else(|| {
                format!(
                    "{name} is none of f, x0, y0, k1, k2, k3, p1, p2, b1, b2, time_offset, lever_arm, boresight, shift, \
                     stage_scale, stage_axis_angle, run_out"
                )
            }),
    }
}

fn estimated(text: &str) -> Result<ParameterList, String> {
    if text.trim() == "none" {
        return Ok(ParameterList(Vec::new()));
    }
    let mut list = Vec::new();
    for name in text.split(',').map(str::trim) {
        for parameter in parameters(name)? {
            if list.contains(&parameter) {
                return Err(format!("{name} appears twice"));
            }
            list.push(parameter);
        }
    }
    Ok(ParameterList(list))
}

fn priors(text: &str) -> Result<PriorList, String> {
    let mut list: Vec<(Parameter, f64)> = Vec::new();
    for part in text.split(',').map(str::trim) {
        let (name, sigma) = part
            .split_once('=')
            .ok_or_else(|| format!("{part} is not NAME=SIGMA"))?;
        let sigma = fmc_camera_file::number::finite(sigma)
            .ok()
            .filter(|sigma| *sigma > 0.0)
            .ok_or_else(|| format!("σ of {name} is not greater than 0: {sigma}"))?;
        for parameter in parameters(name.trim())? {
            if list.iter().any(|(other, _)| *other == parameter) {
                return Err(format!("{name} appears twice"));
            }
            list.push((parameter, sigma));
        }
    }
    Ok(PriorList(list))
}
