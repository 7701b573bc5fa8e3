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
    ArcGis,
    /// A plain table of frames, for no program in particular.
    Frames,
}

impl Program {
    /// Programs for which the calibrated camera is written.
    pub const WRITTEN: [Self; 12] = [
        Self::OpenCv,
        Self::Ros,
        Self::Kalibr,
        Self::Colmap,
        Self::Metashape,
        Self::OpenSfm,
        Self::Opf,
        Self::Pix4d,
        Self::OpenTrackIo,
        Self::MicMac,
        Self::Australis,
        Self::PhotoModeler,
    ];

    /// Programs for which the frames of a flight are written.
    pub const WITH_FRAMES: [Self; 7] = [
        Self::Colmap,
        Self::Metashape,
        Self::OpenSfm,
        Self::Opf,
        Self::OpenTrackIo,
        Self::ArcGis,
        Self::Frames,
    ];

    /// Programs whose files of frames have a place for the exterior orientation.
    pub const WITH_POSES: [Self; 5] = [
        Self::Colmap,
        Self::Metashape,
        Self::OpenSfm,
        Self::Opf,
        Self::ArcGis,
    ];

    /// Programs whose file is read.
    pub const READ: [Self; 15] = [
        Self::OpenCv,
        Self::Ros,
        Self::Kalibr,
        Self::Colmap,
        Self::Metashape,
        Self::OpenSfm,
        Self::Opf,
        Self::Pix4d,
        Self::OpenTrackIo,
        Self::MicMac,
        Self::Australis,
        Self::PhotoModeler,
        Self::Usgs,
        Self::Inpho,
        Self::Dji,
    ];

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
            Self::ArcGis => "arcgis",
            Self::Frames => "frames",
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
}
