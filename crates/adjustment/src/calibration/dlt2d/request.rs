//! Targets and choices of the 2-D direct linear transformation.

use std::sync::Arc;

use fmc_camera_file::CameraFile;
use fmc_reference::residual_splines::ResidualSplines;

use crate::calibration::result::InputFile;

/// A target of the plane in the image.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneTarget {
    /// Line in the file.
    pub line: u64,
    /// Name.
    pub target: Arc<str>,
    /// Measured point in the sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// σ of either coordinate, mm.
    pub sigma_mm: f64,
    /// Place in the plane, m.
    pub plane_m: [f64; 2],
}

/// Targets of one focus setting, with choices.
#[derive(Debug, Clone)]
pub struct Dlt2dRequest<'a> {
    /// File of the observations.
    pub input: InputFile,
    /// `true` if the file has σ.
    pub has_sigma: bool,
    /// Focus setting; `None` without a column `focus`.
    pub focus: Option<Arc<str>>,
    /// Targets.
    pub targets: &'a [PlaneTarget],
    /// Camera file: its f and principal point are kept.
    pub camera: &'a CameraFile,
    /// Its residual grids, which are held; empty for a camera without.
    pub grids: &'a ResidualSplines,
    /// Names of the four targets whose distortion is set to zero; `None` takes all targets.
    pub corners: Option<&'a [String; 4]>,
    /// Coefficients of the camera file that are estimated: K1, K2, K3, P1, P2.
    pub is_estimated: [bool; 5],
    /// `true` if no target is rejected as a gross error.
    pub keeps_all: bool,
}
