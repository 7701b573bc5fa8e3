//! Arguments of the exchange with other programs.

#![expect(
    clippy::doc_markdown,
    reason = "the comments are shown on a terminal, where names have no marks"
)]

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fmc_exchange::program::{Container, Program};

use super::ADVANCED;
use super::number::positive;

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Program whose file is written.
    #[arg(value_name = "FORMAT")]
    pub format: ExportFormat,
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Folder for the files and export.json; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Model of the program: opencv5, opencv8, opencv14; plumb_bob, rational_polynomial;
    /// SIMPLE_RADIAL, OPENCV, FULL_OPENCV and so on. Without it the smallest that leaves less
    /// than 0.01 px.
    #[arg(long, value_name = "NAME")]
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
}

/// Arguments of `import`.
#[derive(Debug, Args)]
pub struct ImportArgs {
    /// Program that wrote the file.
    #[arg(value_name = "FORMAT")]
    pub format: ImportFormat,
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
    /// Report: what was fitted and what it leaves, what was assumed, hashes.
    #[arg(long, value_name = "FILE.json", help_heading = ADVANCED)]
    pub report: Option<PathBuf>,
}

/// Programs whose file is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// OpenCV FileStorage: camera.yaml, or .json, .xml by --as.
    Opencv,
    /// ROS camera_info.yaml.
    Ros,
    /// Kalibr camchain.yaml; without k3.
    Kalibr,
    /// COLMAP cameras, images and points3D, text or --binary.
    Colmap,
    /// Metashape camera.xml.
    Metashape,
    /// OpenSfM camera_models.json, OpenDroneMap cameras.json.
    Opensfm,
    /// Open Photogrammetry Format calibrated_cameras.json.
    Opf,
    /// PIX4Dmapper camera.cam and camera.xmp.
    Pix4d,
    /// OpenTrackIO lens.json, exact without B1, B2.
    Opentrackio,
    /// MicMac AutoCal, DistC2M, exact.
    Micmac,
    /// Australis, exact without B1, B2.
    Australis,
    /// PhotoModeler, exact without B1, B2.
    Photomodeler,
}

impl From<ExportFormat> for Program {
    fn from(format: ExportFormat) -> Self {
        match format {
            ExportFormat::Opencv => Self::OpenCv,
            ExportFormat::Ros => Self::Ros,
            ExportFormat::Kalibr => Self::Kalibr,
            ExportFormat::Colmap => Self::Colmap,
            ExportFormat::Metashape => Self::Metashape,
            ExportFormat::Opensfm => Self::OpenSfm,
            ExportFormat::Opf => Self::Opf,
            ExportFormat::Pix4d => Self::Pix4d,
            ExportFormat::Opentrackio => Self::OpenTrackIo,
            ExportFormat::Micmac => Self::MicMac,
            ExportFormat::Australis => Self::Australis,
            ExportFormat::Photomodeler => Self::PhotoModeler,
        }
    }
}

/// Programs whose file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ImportFormat {
    /// OpenCV FileStorage in YAML, JSON or XML.
    Opencv,
    /// ROS camera_info.
    Ros,
    /// Kalibr camchain.
    Kalibr,
    /// COLMAP cameras.txt or cameras.bin.
    Colmap,
    /// Metashape camera.xml, or a chunk's cameras.xml with --id.
    Metashape,
    /// OpenSfM camera_models.json, OpenDroneMap cameras.json.
    Opensfm,
    /// Open Photogrammetry Format calibrated_cameras.json.
    Opf,
    /// PIX4Dmapper .cam, or XMP.
    Pix4d,
    /// OpenTrackIO sample.
    Opentrackio,
    /// MicMac AutoCal of either direction.
    Micmac,
    /// Australis or iWitness report.
    Australis,
    /// PhotoModeler camera.
    Photomodeler,
    /// Text of a USGS calibration report.
    Usgs,
    /// Inpho project file; --sign is required.
    Inpho,
    /// DewarpData of a DJI image.
    Dji,
}

impl From<ImportFormat> for Program {
    fn from(format: ImportFormat) -> Self {
        match format {
            ImportFormat::Opencv => Self::OpenCv,
            ImportFormat::Ros => Self::Ros,
            ImportFormat::Kalibr => Self::Kalibr,
            ImportFormat::Colmap => Self::Colmap,
            ImportFormat::Metashape => Self::Metashape,
            ImportFormat::Opensfm => Self::OpenSfm,
            ImportFormat::Opf => Self::Opf,
            ImportFormat::Pix4d => Self::Pix4d,
            ImportFormat::Opentrackio => Self::OpenTrackIo,
            ImportFormat::Micmac => Self::MicMac,
            ImportFormat::Australis => Self::Australis,
            ImportFormat::Photomodeler => Self::PhotoModeler,
            ImportFormat::Usgs => Self::Usgs,
            ImportFormat::Inpho => Self::Inpho,
            ImportFormat::Dji => Self::Dji,
        }
    }
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
