//! Programs by name, and the conventions of their files.

use super::model::Model;
use super::{colmap, kalibr, metashape, opencv, opensfm, opf, pix4d, ros};

/// A program whose camera file is written or read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "each variant is the name of a program")]
pub enum Program {
    OpenCv,
    Ros,
    Kalibr,
    Colmap,
    Metashape,
    OpenSfm,
    Opf,
    Pix4d,
    OpenTrackIo,
    MicMac,
    Australis,
    PhotoModeler,
    Usgs,
    Inpho,
    Dji,
}

/// Conventions of a file, in words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Conventions {
    /// Place that is (0, 0).
    pub origin: &'static str,
    /// Unit of lengths and of the coefficients.
    pub unit: &'static str,
    /// Meaning of the coefficients' sign.
    pub sign: &'static str,
    /// Advice to the user of the program.
    pub advice: &'static str,
}

const DISTORTS: &str = "added to the ideal ray: a barrel lens has k1 < 0";
const CORRECTS: &str = "correction, added to the measured point: a barrel lens has K1 > 0";
const RAYS: &str = "px; coefficients of rays (z = 1)";
const FIRST_PIXEL: &str = "centre of the first pixel, y down";
const CORNER: &str = "upper left corner, y down: the first pixel centre is at (0.5, 0.5)";
const MIDDLE: &str = "middle of the image, y down";

impl Program {
    /// Returns the name that the command line uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OpenCv => "opencv",
            Self::Ros => "ros",
            Self::Kalibr => "kalibr",
            Self::Colmap => "colmap",
            Self::Metashape => "metashape",
            Self::OpenSfm => "opensfm",
            Self::Opf => "opf",
            Self::Pix4d => "pix4d",
            Self::OpenTrackIo => "opentrackio",
            Self::MicMac => "micmac",
            Self::Australis => "australis",
            Self::PhotoModeler => "photomodeler",
            Self::Usgs => "usgs",
            Self::Inpho => "inpho",
            Self::Dji => "dji",
        }
    }

    /// Returns the models of a program that distorts rays, the smallest first; none for one that
    /// corrects measured points, or whose files are only read.
    #[must_use]
    pub const fn models(self) -> &'static [Model] {
        match self {
            Self::OpenCv => opencv::MODELS,
            Self::Ros => ros::MODELS,
            Self::Kalibr => kalibr::MODELS,
            Self::Colmap => colmap::MODELS,
            Self::Metashape => metashape::MODELS,
            Self::OpenSfm => opensfm::MODELS,
            Self::Opf => opf::MODELS,
            Self::Pix4d => pix4d::MODELS,
            _ => &[],
        }
    }

    /// Returns the conventions of the program's file.
    #[must_use]
    pub const fn conventions(self) -> Conventions {
        let (origin, unit, sign, advice) = match self {
            Self::OpenCv => (
                FIRST_PIXEL,
                RAYS,
                DISTORTS,
                "undistortPoints converges on these coefficients; initUndistortRectifyMap needs \
                 none of its defaults changed",
            ),
            Self::Ros => (
                FIRST_PIXEL,
                RAYS,
                DISTORTS,
                "projection_matrix is that of the undistorted image with the same principal point",
            ),
            Self::Kalibr => (FIRST_PIXEL, RAYS, DISTORTS, "radtan has no k3"),
            Self::Colmap => (
                CORNER,
                RAYS,
                DISTORTS,
                "hold the camera: refine_focal_length, refine_principal_point and \
                 refine_extra_params 0",
            ),
            Self::Metashape => (
                MIDDLE,
                "px; coefficients of rays (z = 1); P1 goes with x²",
                DISTORTS,
                "Tools, Camera Calibration, Initial: load the file, and fix all parameters",
            ),
            Self::OpenSfm => (
                MIDDLE,
                "longer side of the image; coefficients of rays (z = 1)",
                DISTORTS,
                "the key must be the one the program computes from the images (--id); hold it: \
                 optimize_camera_parameters no; OpenDroneMap: --cameras, \
                 --use-fixed-camera-params",
            ),
            Self::Opf => (
                CORNER,
                RAYS,
                DISTORTS,
                "the file has no place for the size of the image",
            ),
            Self::Pix4d => (
                "upper left corner, y down: the first pixel centre is at half the pitch",
                "mm; coefficients of rays (z = 1)",
                DISTORTS,
                "Image Properties Editor, Edit Camera Model; Processing Options, Calibration, \
                 internal parameters optimisation None",
            ),
            Self::OpenTrackIo => (
                "middle of the sensor, y down",
                "mm",
                "measured -> ideal: a barrel lens has radial[0] > 0",
                "numerator and denominator alternate in radial",
            ),
            Self::MicMac => (
                "centre of the first pixel, y down; read in the source, not verified: half a \
                 pixel is possible",
                "px",
                "eConvApero_DistC2M, measured -> ideal: a barrel lens has CoeffDist > 0",
                "Ori-CalInit with this file, Tapas Figee with InCal; Tapas itself writes the \
                 other direction, DistM2C",
            ),
            Self::Australis => (
                "middle of the sensor, y up",
                "mm",
                CORRECTS,
                "B1 and B2 are 0",
            ),
            Self::PhotoModeler => (
                "left and upper edge of the format; XP, YP: middle, y up",
                "mm",
                CORRECTS,
                "P1 goes with x²; the help prints P in mm⁻², it is mm⁻¹",
            ),
            Self::Usgs => (
                "principal point of autocollimation, y up",
                "mm",
                CORRECTS,
                "",
            ),
            Self::Inpho => (
                "centre of the first pixel; principal point in mm, y up",
                "mm",
                "as stated with --sign: the file does not say",
                "",
            ),
            Self::Dji => (MIDDLE, RAYS, DISTORTS, ""),
        };
        Conventions {
            origin,
            unit,
            sign,
            advice,
        }
    }
}
