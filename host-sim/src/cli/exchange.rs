//! Arguments of the exchange with other programs.

#![expect(
    clippy::doc_markdown,
    reason = "the comments are shown on a terminal, where names have no marks"
)]

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use fmc_exchange::frames::{PATTERN, Pattern};
use fmc_exchange::program::{Container, Program};

use super::ADVANCED;
use super::TrajectoryArgs;
use super::number::positive;

/// Arguments of `export`.
#[derive(Debug, Args)]
#[command(
    mut_arg("trajectory", |arg| arg.requires("records")),
    // Its name is orientation.csv, in the folder.
    mut_arg("orientation", |arg| arg.hide(true).conflicts_with("trajectory"))
)]
pub struct ExportArgs {
    /// Program whose file is written.
    #[arg(value_name = "FORMAT", value_parser = program(&EXPORTED))]
    pub format: Program,
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Folder for the files and export.json; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Records of a flight, records.csv or records.json: a camera per image, for colmap, metashape,
    /// opensfm, opf, opentrackio, arcgis and frames.
    #[arg(long, value_name = "FILE")]
    pub records: Option<PathBuf>,
    /// Model of the program: opencv5, opencv8, opencv14; plumb_bob, rational_polynomial;
    /// SIMPLE_RADIAL, OPENCV, FULL_OPENCV and so on. Without it the smallest that leaves less
    /// than 0.01 px.
    #[arg(long, value_name = "NAME", help_heading = ADVANCED)]
    pub model: Option<String>,
    /// Largest residual over the sensor, µm: above it nothing is written, exit code 1.
    #[arg(long, value_name = "UM", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    pub max_residual_um: Option<f64>,
    /// Container of opencv's file: camera.yaml, camera.json or camera.xml.
    #[arg(long = "as", value_name = "CONTAINER", help_heading = ADVANCED)]
    pub container: Option<ContainerName>,
    /// Write colmap's binary files in place of text.
    #[arg(long, help_heading = ADVANCED)]
    pub binary: bool,
    /// Name of the camera in opensfm's file, such as `v2 make model 14204 10652 brown 0.9618`: the
    /// program must find the camera of its images by it.
    #[arg(long, value_name = "NAME", help_heading = ADVANCED)]
    pub id: Option<String>,
    /// Names of the images: a CSV table with the columns sequence and image.
    #[arg(
        long,
        value_name = "MAP.csv",
        requires = "records",
        conflicts_with = "image_name",
        help_heading = ADVANCED
    )]
    pub images: Option<PathBuf>,
    /// Names of the images without such a table; {sequence:05} is the number of the trigger with
    /// five digits at least.
    #[arg(long, value_name = "PATTERN", requires = "records", value_parser = Pattern::parse,
          default_value = PATTERN, help_heading = ADVANCED)]
    pub image_name: Pattern,
    /// The trajectory of the flight: orientation.csv is written, too.
    #[command(flatten)]
    pub trajectory: TrajectoryArgs,
}

/// Arguments of `import`.
#[derive(Debug, Args)]
pub struct ImportArgs {
    /// Program that wrote the file.
    #[arg(value_name = "FORMAT", value_parser = program(&IMPORTED))]
    pub format: Program,
    /// File of the program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Camera file to be written (TOML).
    #[arg(long, value_name = "CAMERA.toml")]
    pub out: PathBuf,
    /// Pixel pitch, µm; hardly any program's file has it. Without it that of --base.
    #[arg(long, value_name = "P", value_parser = positive, allow_negative_numbers = true)]
    pub pixel_um: Option<f64>,
    /// Columns and rows of the array, where the file does not have them. Without it those of
    /// --base.
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = ADVANCED)]
    pub size: Option<[u32; 2]>,
    /// Name of the camera in a file with several.
    #[arg(long, value_name = "ID", help_heading = ADVANCED)]
    pub id: Option<String>,
    /// Sign of the coefficients, where the file does not tell it: inpho.
    #[arg(long, value_name = "SIGN", help_heading = ADVANCED)]
    pub sign: Option<SignName>,
    /// Camera file from which mechanism, shutter, limits, exit pupil, serial number and name are
    /// taken.
    #[arg(long, value_name = "CAMERA.toml")]
    pub base: Option<PathBuf>,
    /// Write what the polynomial leaves of the file's model as a residual grid of the lens, beside
    /// the camera file: at most 5 nm are left where a grid can hold the model.
    #[arg(long, help_heading = ADVANCED)]
    pub grid: bool,
    /// Report: what was fitted and what it leaves, what was assumed, hashes.
    #[arg(long, value_name = "FILE.json", help_heading = ADVANCED)]
    pub report: Option<PathBuf>,
}

/// Formats of `export`, each with what is written for it.
const EXPORTED: [(Program, &str); 14] = [
    (
        Program::OpenCv,
        "OpenCV FileStorage: camera.yaml, or .json, .xml by --as",
    ),
    (Program::Ros, "ROS camera_info.yaml"),
    (Program::Kalibr, "Kalibr camchain.yaml; without k3"),
    (
        Program::Colmap,
        "COLMAP cameras, images and points3D, text or --binary",
    ),
    (Program::Metashape, "Metashape camera.xml"),
    (
        Program::OpenSfm,
        "OpenSfM camera_models.json, OpenDroneMap cameras.json",
    ),
    (
        Program::Opf,
        "Open Photogrammetry Format calibrated_cameras.json",
    ),
    (Program::Pix4d, "PIX4Dmapper camera.cam and camera.xmp"),
    (
        Program::OpenTrackIo,
        "OpenTrackIO lens.json, exact without B1, B2",
    ),
    (Program::MicMac, "MicMac AutoCal, DistC2M, exact"),
    (Program::Australis, "Australis, exact without B1, B2"),
    (Program::PhotoModeler, "PhotoModeler, exact without B1, B2"),
    (
        Program::ArcGis,
        "ArcGIS frame cameras: cameras.csv and frames.csv; with --records alone",
    ),
    (
        Program::Frames,
        "frames.csv, a plain table of times and principal points; with --records alone",
    ),
];

/// Formats of `import`, each with what is read of it.
const IMPORTED: [(Program, &str); 15] = [
    (Program::OpenCv, "OpenCV FileStorage in YAML, JSON or XML"),
    (Program::Ros, "ROS camera_info"),
    (Program::Kalibr, "Kalibr camchain"),
    (Program::Colmap, "COLMAP cameras.txt or cameras.bin"),
    (
        Program::Metashape,
        "Metashape camera.xml, or a chunk's cameras.xml with --id",
    ),
    (
        Program::OpenSfm,
        "OpenSfM camera_models.json, OpenDroneMap cameras.json",
    ),
    (
        Program::Opf,
        "Open Photogrammetry Format calibrated_cameras.json",
    ),
    (Program::Pix4d, "PIX4Dmapper .cam, or XMP"),
    (Program::OpenTrackIo, "OpenTrackIO sample"),
    (Program::MicMac, "MicMac AutoCal of either direction"),
    (Program::Australis, "Australis or iWitness report"),
    (Program::PhotoModeler, "PhotoModeler camera"),
    (Program::Usgs, "Text of a USGS calibration report"),
    (Program::Inpho, "Inpho project file; --sign is required"),
    (Program::Dji, "DewarpData of a DJI image"),
];

/// Returns the parser of the names of some formats.
fn program<const N: usize>(
    formats: &'static [(Program, &'static str); N],
) -> impl TypedValueParser<Value = Program> {
    let values = formats
        .iter()
        .map(|(program, help)| PossibleValue::new(program.name()).help(*help));
    PossibleValuesParser::new(values).try_map(|name| {
        formats
            .iter()
            .map(|(program, _)| *program)
            .find(|program| program.name() == name)
            .ok_or("not a format")
    })
}

/// Container of OpenCV's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ContainerName {
    /// camera.yaml.
    Yaml,
    /// camera.json.
    Json,
    /// camera.xml.
    Xml,
}

impl From<ContainerName> for Container {
    fn from(name: ContainerName) -> Self {
        match name {
            ContainerName::Yaml => Self::Yaml,
            ContainerName::Json => Self::Json,
            ContainerName::Xml => Self::Xml,
        }
    }
}

/// Sign of coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SignName {
    /// To be added to the measured point.
    Correction,
    /// Measured - ideal.
    Distortion,
}

/// Reads a size such as 14204x10652.
fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |word: &str| word.trim().parse::<u32>().ok().filter(|side| *side > 0);
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| "not columns and rows such as 14204x10652".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_is_columns_and_rows() {
        assert_eq!(size("14204x10652"), Ok([14204, 10652]));
        for text in ["", "14204", "0x5", "-1x5", "1x2x3", "axb"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
