//! Arguments of whole frames.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};
use fmc_rectification::Resampling;

use super::frames::{FRAMES, optional_group};
use super::{ADVANCED, ExposureArgs};

/// Heading of the options for the rectified image.
const IMAGE: &str = "Rectified image";
/// Heading of the options for files of images.
const FILES: &str = "Files of images";
/// Heading of the options for blocks.
const BLOCKS: &str = "Blocks of frames";

/// Arguments of `rectify`.
#[derive(Debug, Args)]
#[group(skip)]
#[command(
    mut_arg("exposure", |arg| arg.required(false).required_unless_present("records")),
    mut_group("vh_or_speed", optional_group),
    group = ArgGroup::new("records_or_vh")
        .args(["vh", "ground_speed", "records"])
        .multiple(true)
        .required(true),
    group = ArgGroup::new("frames_or_table")
        .args(["inputs", "frames"])
        .multiple(true)
        .required(true)
)]
pub struct RectifyArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// Frames as the camera recorded them (TIFF). The number that ends a file's name, before its
    /// extension, is the sequence number of its record.
    #[arg(value_name = "FRAME.tif")]
    pub inputs: Vec<PathBuf>,
    /// Folder for the rectified frames, a JSON file beside each, rectified-camera.toml and
    /// manifest.csv; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Records of the flight, records.csv or records.json; they must be of the calibration of
    /// --camera.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "vh", "ground_speed", "height", "exposure", "opening_offset_mm",
            "focus_shift_um", "focus_sign", "model", "direction",
        ],
        help_heading = FRAMES
    )]
    pub records: Option<PathBuf>,
    /// Frames with the sequence numbers of their records: CSV with the columns `file` and
    /// `sequence`. A name is looked for in the folder of the table, then in the working folder.
    /// With FRAME.tif, only those of its frames are rectified.
    #[arg(long, value_name = "FRAMES.csv", requires = "records", help_heading = FRAMES)]
    pub frames: Option<PathBuf>,
    /// The rectified image.
    #[command(flatten)]
    pub image: RectifiedImageArgs,
    /// Its file.
    #[command(flatten)]
    pub file: ImageFileArgs,
    /// The block.
    #[command(flatten)]
    pub block: BlockArgs,
}

/// The rectified image.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = IMAGE)]
pub struct RectifiedImageArgs {
    /// Centre of the rectified image.
    #[arg(long, value_name = "CENTRE", default_value = "principal-point")]
    pub centre: CentreName,
    /// Size of the rectified image: same as the frame's; inside, the largest whose every pixel has
    /// a source on the sensor; full, the smallest that holds every recorded pixel; or `WxH`, in
    /// pixels.
    #[arg(long, value_name = "WINDOW", default_value = "same", value_parser = window)]
    pub window: WindowArgument,
    /// Interpolation between the recorded pixels.
    #[arg(long, value_name = "KERNEL", default_value = "bicubic")]
    pub resample: ResamplingName,
    /// Add a page of one bit: 1 where the rectified image has a source on the sensor.
    #[arg(long)]
    pub mask: bool,
}

/// Files of images.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = FILES)]
pub struct ImageFileArgs {
    /// Compression; without it that of the frame.
    #[arg(long, value_name = "COMPRESSION")]
    pub compression: Option<CompressionName>,
    /// Tiles of this side, pixels, a multiple of 16; without it and --strip as in the frame.
    #[arg(long, value_name = "PX", conflicts_with = "strip", value_parser = tile_side)]
    pub tile: Option<u32>,
    /// Strips of this many rows.
    #[arg(long, value_name = "ROWS", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub strip: Option<u32>,
    /// BigTIFF, which is also taken whenever a file could exceed 4 GB.
    #[arg(long)]
    pub bigtiff: bool,
}

/// Blocks of frames.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = BLOCKS)]
pub struct BlockArgs {
    /// Leave frames as they are that an earlier run with the same options has finished.
    #[arg(long)]
    pub resume: bool,
    /// Part K of N of the frames, for N machines; the manifest is manifest-K-of-N.csv.
    #[arg(long, value_name = "K/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Go on after a frame that cannot be rectified; the manifest says why, and the exit code is
    /// that of the worst.
    #[arg(long)]
    pub keep_going: bool,
    /// Threads; without it as many as the processor has.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = ADVANCED)]
    pub threads: Option<u16>,
    /// Largest memory for rows of a frame that are being resampled, MiB; besides them a strip, a
    /// row of tiles of up to 64 MiB or a row of pixels is held before and after.
    #[arg(long, value_name = "MIB", default_value = "512", value_parser = clap::value_parser!(u32).range(1..), help_heading = ADVANCED)]
    pub memory: u32,
}

/// Centres of a rectified image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CentreName {
    /// The principal point of the exposure: one camera for all frames.
    PrincipalPoint,
    /// The centre of the frame; the principal point stays where the record has it.
    Frame,
}

impl CentreName {
    /// Returns the name that the command line uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PrincipalPoint => "principal-point",
            Self::Frame => "frame",
        }
    }
}

/// Sizes of a rectified image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WindowArgument {
    /// That of the frame.
    Same,
    /// The largest whose every pixel has a source on the sensor.
    Inside,
    /// The smallest that holds every recorded pixel.
    Full,
    /// Width and height, pixels.
    Size([u32; 2]),
}

/// Interpolations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ResamplingName {
    /// The nearest pixel: up to half a pixel off.
    Nearest,
    /// Two pixels each way; smooths.
    Bilinear,
    /// Four pixels each way, Keys with a = -1/2, as GDAL and vips have it.
    Bicubic,
    /// Six pixels each way, Keys 1981, fourth order: for measuring.
    Keys6,
    /// Six pixels each way; sharp, but a ramp is off by up to 0.020 px.
    Lanczos3,
}

impl ResamplingName {
    /// Returns the kernel.
    #[must_use]
    pub const fn kernel(self) -> Resampling {
        match self {
            Self::Nearest => Resampling::Nearest,
            Self::Bilinear => Resampling::Bilinear,
            Self::Bicubic => Resampling::Bicubic,
            Self::Keys6 => Resampling::Keys6,
            Self::Lanczos3 => Resampling::Lanczos3,
        }
    }

    /// Returns the name that the command line uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Bilinear => "bilinear",
            Self::Bicubic => "bicubic",
            Self::Keys6 => "keys6",
            Self::Lanczos3 => "lanczos3",
        }
    }
}

/// Compressions of the rectified frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CompressionName {
    /// Uncompressed.
    None,
    /// LZW.
    Lzw,
    /// Deflate, as in ZIP.
    Deflate,
    /// Zstandard, which not every program reads.
    Zstd,
}

impl CompressionName {
    /// Returns the name that the command line uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Lzw => "lzw",
            Self::Deflate => "deflate",
            Self::Zstd => "zstd",
        }
    }
}

/// A part of the frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u32,
    /// Number of parts.
    pub of: u32,
}

fn window(text: &str) -> Result<WindowArgument, String> {
    let size = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        let [width, height] = [width.trim().parse().ok()?, height.trim().parse().ok()?];
        (width > 0 && height > 0).then_some(WindowArgument::Size([width, height]))
    };
    match text {
        "same" => Ok(WindowArgument::Same),
        "inside" => Ok(WindowArgument::Inside),
        "full" => Ok(WindowArgument::Full),
        _ => size().ok_or_else(|| {
            "same, inside, full, or width and height in pixels such as 14000x10500".to_owned()
        }),
    }
}

fn tile_side(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(side) if side % 16 == 0 && (16..=4096).contains(&side) => Ok(side),
        _ => Err("a multiple of 16 from 16 to 4096".to_owned()),
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text
        .split_once('/')
        .and_then(|(number, of)| Some((number.trim().parse().ok()?, of.trim().parse().ok()?)));
    match numbers {
        Some((number, of)) if number >= 1 && number <= of => Ok(Shard { number, of }),
        _ => Err("K/N with K from 1 to N, such as 2/3".to_owned()),
    }
}
