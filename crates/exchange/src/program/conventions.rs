//! Conventions of the programs' files, in words.

use super::Program;

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
const WITHOUT: &str = "no coefficients";
const RAYS: &str = "px; coefficients of rays (z = 1)";
const FIRST_PIXEL: &str = "centre of the first pixel, y down";
const CORNER: &str = "upper left corner, y down: the first pixel centre is at (0.5, 0.5)";
const MIDDLE: &str = "middle of the image, y down";

/// Origin, unit, sign and advice.
type Words = (&'static str, &'static str, &'static str, &'static str);

const ARCGIS: Words = (
    "middle of the sensor, y up",
    "µm",
    WITHOUT,
    "images and points must be corrected: host-sim correct; PrincipalX and PrincipalY \
     of the frames go before the camera's; join the exterior orientation to \
     frames.csv",
);

const FRAMES: Words = (
    "mm: middle of the sensor, y up; col, row: centre of the first pixel; corner: \
     upper left corner, y down",
    "mm and px, as the columns say",
    WITHOUT,
    "principal_distance_mm goes with corrected points, enlarged_distance_mm with \
     measured ones",
);

impl Program {
    /// Returns the advice to the user of a program that takes a camera per image.
    #[must_use]
    pub const fn advice_on_frames(self) -> &'static str {
        match self {
            Self::Colmap => {
                "hold the cameras: refine_focal_length, refine_principal_point and \
                 refine_extra_params 0; refined, each is a free interior orientation of one image. \
                 Without --trajectory images.txt has no poses: all are at the origin"
            }
            Self::Metashape => {
                "File, Import, Import Cameras: cameras.xml; or Tools, Run Script: frames.py. \
                 Cameras are found by label, the name of the image without its extension, and are \
                 fixed. reference.csv, with --trajectory: Import Reference, angles omega, phi, kappa"
            }
            Self::OpenSfm => {
                "both files into the data set before extract_metadata; hold the cameras: \
                 optimize_camera_parameters no"
            }
            Self::Opf => {
                "positions and orientations are placeholders, all 0: take sensors and sensor_id \
                 of them. The file has no place for the size of the image or for a time"
            }
            Self::OpenTrackIo => {
                "a sample per line; sampleTimestamp is the centroid as PTP counts it: TAI; \
                 coefficients go with the enlarged image"
            }
            other => other.conventions().advice,
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
            Self::ArcGis => ARCGIS,
            Self::Frames => FRAMES,
        };
        Conventions {
            origin,
            unit,
            sign,
            advice,
        }
    }
}
