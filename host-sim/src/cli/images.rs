//! Arguments of images that are rendered and compared.

use std::path::PathBuf;

use clap::Args;
use fmc_camera_file::number::finite;

use super::{ADVANCED, ExposureArgs};

/// Heading of the options for what the camera sees.
const PATTERN: &str = "Pattern";

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// Folder for frame.tif, as the camera records the pattern; rectified.tif, as `rectify` would
    /// answer without any error; camera.toml and render.json. Made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Image that the camera sees, as it would be rectified: TIFF of the camera's width and height.
    /// Without it a pattern of waves.
    #[arg(long, value_name = "IMAGE.tif", help_heading = PATTERN, conflicts_with_all = ["periods", "seed", "bands", "bits"])]
    pub image: Option<PathBuf>,
    /// Periods of the waves, pixels; 12 to 100000.
    #[arg(long, value_name = "PX,PX", value_delimiter = ',', help_heading = PATTERN, default_value = "12,18,27,40,60,90,135,200", value_parser = period, allow_negative_numbers = true)]
    pub periods: Vec<f64>,
    /// Seed of the waves' directions and phases.
    #[arg(long, value_name = "N", default_value = "1", help_heading = PATTERN)]
    pub seed: u64,
    /// Bands: 1, 3 or 4.
    #[arg(long, value_name = "N", default_value = "1", value_parser = bands, help_heading = PATTERN)]
    pub bands: u8,
    /// Bits of a sample: 8 or 16.
    #[arg(long, value_name = "N", default_value = "16", value_parser = bits, help_heading = PATTERN)]
    pub bits: u8,
    /// Pixels so many times as wide, and so many times fewer: the same lens, a smaller image.
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=64), help_heading = ADVANCED)]
    pub scale: u16,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Image that is the measure (TIFF).
    #[arg(value_name = "A.tif")]
    pub first: PathBuf,
    /// Image that is compared with it, of the same size and bands.
    #[arg(value_name = "B.tif")]
    pub second: PathBuf,
    /// Pixels along each edge that are left out, of the images and of where either of them has no
    /// content (0 in all bands).
    #[arg(long, value_name = "PX", default_value = "4", value_parser = clap::value_parser!(u16).range(0..=4096), help_heading = ADVANCED)]
    pub edge: u16,
    /// Folder for shifts.csv, shifts.svg and summary.json; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Longest shift of a block that passes, pixels; beyond it the exit code is 1.
    #[arg(long, value_name = "PX", value_parser = finite, allow_negative_numbers = true)]
    pub max_px: Option<f64>,
    /// Largest difference of a grey value that passes, counts; beyond it the exit code is 1.
    #[arg(long, value_name = "COUNTS", value_parser = finite, allow_negative_numbers = true)]
    pub max_grey: Option<f64>,
}

fn period(text: &str) -> Result<f64, String> {
    match finite(text)? {
        period if (12.0..=100_000.0).contains(&period) => Ok(period),
        _ => Err("not a period from 12 to 100000 pixels".to_owned()),
    }
}

fn bands(text: &str) -> Result<u8, String> {
    match text.parse() {
        Ok(bands @ (1 | 3 | 4)) => Ok(bands),
        _ => Err("1, 3 or 4".to_owned()),
    }
}

fn bits(text: &str) -> Result<u8, String> {
    match text.parse() {
        Ok(bits @ (8 | 16)) => Ok(bits),
        _ => Err("8 or 16".to_owned()),
    }
}
