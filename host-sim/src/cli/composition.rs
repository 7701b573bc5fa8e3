//! Arguments of cameras of several detectors: scene, radiometry, rig, virtual image.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::number::{between, positive};
use super::{ADVANCED, ResamplingName, examples};

/// Heading of the options for what the synthetic camera is like.
const CAMERA: &str = "Camera and ground";
/// Heading of the options for the way of calibration or composition.
const WAY: &str = "Way";

/// Arguments of `scene`.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Camera of the scene.
    #[command(subcommand)]
    pub camera: SceneCamera,
}

/// Cameras of scenes.
#[derive(Debug, Subcommand)]
pub enum SceneCamera {
    /// Six detectors behind one lens and a green camera beside it, over 212 ground marks: Zhao et
    /// al. 2013.
    ///
    /// The folder gets rig.toml (nominal), flats/ and darks/ of the six detectors, the exposures
    /// `8_10/` and `8_11/` with `1.tif` to `6.tif` and green.tif, control.csv and ties.csv as they
    /// are measured, and truth/: virtual images without any error, orientations, marks, defects.
    /// Image points are measured with noise, not read from the images, which show no marks; green
    /// has no radiometric errors but noise.
    #[command(after_help = examples::SCENE_DMZ)]
    Dmz(DmzSceneArgs),
}

/// Arguments of `scene dmz`.
#[derive(Debug, Args)]
pub struct DmzSceneArgs {
    /// Folder for the scene; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Properties of the scene.
    #[command(flatten)]
    pub scene: SceneOptions,
    /// Dark frames of each detector, 1 to 64.
    #[arg(long, value_name = "N", default_value = "4", value_parser = clap::value_parser!(u8).range(1..=64), help_heading = CAMERA)]
    pub darks: u8,
}

/// Properties of a scene.
#[derive(Debug, Clone, Args)]
pub struct SceneOptions {
    /// Pixels so many times as wide, so many times fewer, and flown so many times lower: the ground
    /// sample distance of 0.275 m stays, and with it what a metre of relief does in pixels.
    #[arg(long, value_name = "N", default_value = "8", value_parser = clap::value_parser!(u8).range(1..=16))]
    pub scale: u8,
    /// Standard deviation of the heights of the ground, m.
    #[arg(long, value_name = "M", default_value = "5", value_parser = between(0.0, 1000.0), allow_negative_numbers = true, help_heading = CAMERA)]
    pub relief: f64,
    /// Tilt of the exposures (standard deviation of pitch and roll), degrees.
    #[arg(long, value_name = "DEG", default_value = "1", value_parser = between(0.0, 5.0), allow_negative_numbers = true, help_heading = CAMERA)]
    pub tilt: f64,
    /// σ of measured image points, px.
    #[arg(long, value_name = "PX", default_value = "0.25", value_parser = between(0.0, 10.0), allow_negative_numbers = true, help_heading = CAMERA)]
    pub noise: f64,
    /// σ of each coordinate of control, m.
    #[arg(long, value_name = "M", default_value = "0.05", value_parser = between(0.0, 10.0), allow_negative_numbers = true, help_heading = CAMERA)]
    pub control_sigma: f64,
    /// Distortion of the lens at the corner, percent of the radius.
    #[arg(long, value_name = "PERCENT", default_value = "0.05", value_parser = between(-2.0, 2.0), allow_negative_numbers = true, help_heading = CAMERA)]
    pub distortion: f64,
    /// Distortion of green's lens at its corner, percent of the radius.
    #[arg(long, value_name = "PERCENT", default_value = "0.2", value_parser = between(-2.0, 2.0), allow_negative_numbers = true, help_heading = CAMERA)]
    pub green_distortion: f64,
    /// Overlap of neighbouring sub-images, px; without it 128 over the scale, at least 64.
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u16).range(16..=1024), help_heading = CAMERA)]
    pub overlap: Option<u16>,
    /// Ground marks over both exposures.
    #[arg(long, value_name = "N", default_value = "212", value_parser = clap::value_parser!(u16).range(0..=10_000), help_heading = CAMERA)]
    pub marks: u16,
    /// Ties measured in each overlap of an exposure.
    #[arg(long, value_name = "N", default_value = "20", value_parser = clap::value_parser!(u16).range(0..=1000), help_heading = CAMERA)]
    pub ties: u16,
    /// Seed of everything random.
    #[arg(long, value_name = "N", default_value = "1")]
    pub seed: u64,
}

/// Arguments of `calibrate radiometry`.
#[derive(Debug, Args)]
pub struct RadiometryArgs {
    /// Folder with `flats/ID_NN.tif` and `darks/ID_NN.tif` of every sub-image ID, NN being the set
    /// that all sub-images share. Optional `flats/levels.csv`: `set,exposure_s`, and `irradiance`
    /// in any unit where the source changed; with it linearity is told.
    #[arg(value_name = "DIR")]
    pub frames: PathBuf,
    /// Rig file (TOML): ids, sizes and places of the sub-images.
    #[arg(long, value_name = "FILE")]
    pub rig: PathBuf,
    /// Folder for `ID_offset.tif`, `ID_gain.tif`, defects.csv and radiometry.json; made if it does
    /// not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Offset and gain of every pixel, or the template of Zhao et al. 2013, which is subtracted and
    /// is right at one level only.
    #[arg(long, value_name = "METHOD", default_value = "offset-and-gain")]
    pub method: RadiometryMethod,
    /// Sample from which on a pixel counts as saturated, DN.
    #[arg(long, value_name = "DN", default_value = "16100", value_parser = clap::value_parser!(u16).range(16..), help_heading = ADVANCED)]
    pub saturation: u16,
}

/// Methods of the radiometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum RadiometryMethod {
    /// Offset and gain of every pixel.
    OffsetAndGain,
    /// Zhao et al. 2013.
    Template,
}

/// Arguments of `calibrate rig`.
#[derive(Debug, Args)]
pub struct RigArgs {
    /// Control (CSV): `id,image,col_px,row_px,x_m,y_m,z_m,sigma_m`, image being the id of a
    /// sub-image; optional `exposure`.
    #[arg(value_name = "CONTROL.csv")]
    pub control: PathBuf,
    /// Rig file (TOML).
    #[arg(long, value_name = "FILE")]
    pub rig: PathBuf,
    /// Ties (CSV): `id,image,col_px,row_px`, one id in two images; optional `exposure`.
    #[arg(long, value_name = "FILE")]
    pub ties: Option<PathBuf>,
    /// Folder for rig.toml with the polynomials, correlations.csv, residuals.csv, residuals.svg and
    /// summary.json; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Project control with its height by the orientation of its exposure, or lead to X, Y of the
    /// ground as Zhao et al. 2013 do.
    #[arg(long, value_name = "HOW", default_value = "use", help_heading = WAY)]
    pub heights: HeightsName,
    /// Degree of the polynomials, 2 to 5.
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u8).range(2..=5), help_heading = WAY)]
    pub degree: u8,
    /// Exposure whose points are used; without it all.
    #[arg(id = "of_exposure", long = "exposure", value_name = "NAME", help_heading = WAY)]
    pub exposure: Option<String>,
    /// σ of measured image points, px.
    #[arg(long, value_name = "PX", default_value = "0.25", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub sigma_px: f64,
}

/// Treatment of the heights of control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HeightsName {
    /// The polynomials are the camera's.
    Use,
    /// The polynomials lead to X, Y of the ground, of one exposure.
    Ignore,
}

/// Arguments of `virtual`.
#[derive(Debug, Args)]
pub struct VirtualArgs {
    /// Folder of an exposure: a TIFF ID.tif of every sub-image, and green.tif where the rig has
    /// green.
    #[arg(value_name = "EXPOSURE")]
    pub exposure: PathBuf,
    /// Calibrated rig file (TOML).
    #[arg(long, value_name = "FILE")]
    pub rig: PathBuf,
    /// Folder of `calibrate radiometry`; without it grey values stay as recorded.
    #[arg(long, value_name = "DIR")]
    pub radiometry: Option<PathBuf>,
    /// Folder for virtual.tif, mask.tif, labels.tif, ties.csv, report.html and summary.json; made
    /// if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Rectify each sub-image by its polynomial, or shift them to a mosaic and rectify that with
    /// one polynomial of degree 3.
    #[arg(long, value_name = "ORDER", default_value = "rectify-first", help_heading = WAY)]
    pub order: OrderName,
    /// Kernel.
    #[arg(long, value_name = "KERNEL", default_value = "bicubic", help_heading = WAY)]
    pub resample: ResamplingName,
    /// Pixels on either side of a seam within which two sub-images are mixed.
    #[arg(long, value_name = "PX", default_value = "5", value_parser = clap::value_parser!(u8).range(0..=64), help_heading = ADVANCED)]
    pub feather: u8,
    /// Largest memory, MiB: all sub-images of an exposure and the virtual image are held, 8 bytes
    /// of a pixel.
    #[arg(long, value_name = "MIB", default_value = "4096", value_parser = clap::value_parser!(u32).range(1..), help_heading = ADVANCED)]
    pub memory: u32,
}

/// Order of rectification and mosaic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OrderName {
    /// Each sub-image by its own polynomial.
    RectifyFirst,
    /// Shifts, then one polynomial over the frame.
    MosaicFirst,
}

/// Arguments of `stereo`.
#[derive(Debug, Args)]
pub struct StereoArgs {
    /// First virtual image (TIFF).
    #[arg(value_name = "FIRST.tif")]
    pub first: PathBuf,
    /// Second virtual image.
    #[arg(value_name = "SECOND.tif")]
    pub second: PathBuf,
    /// Rig file (TOML): size and principal distance of the virtual images.
    #[arg(long, value_name = "FILE")]
    pub rig: PathBuf,
    /// Marks (CSV): `id,image,col_px,row_px,x_m,y_m,z_m`, measured in both virtual images, image
    /// being 1 or 2.
    #[arg(long, value_name = "FILE")]
    pub marks: PathBuf,
    /// Folder for summary.json; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// σ of image points, px.
    #[arg(long, value_name = "PX", default_value = "0.3", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub sigma_px: f64,
    /// σ of each coordinate of control, m.
    #[arg(long, value_name = "M", default_value = "0.05", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub control_sigma: f64,
}

/// Arguments of `dmz`.
#[derive(Debug, Args)]
pub struct DmzArgs {
    /// Folder for report.html, summary.json, the scene and both virtual images; made if it does not
    /// exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Properties of the scene.
    #[command(flatten)]
    pub scene: SceneOptions,
}
