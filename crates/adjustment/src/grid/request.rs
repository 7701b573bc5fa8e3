//! Table of distortions, with choices.

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::CameraFile;
use fmc_reference::lens::Lens;

use super::lattice::Lattice;
use super::polynomial::COEFFICIENTS;
use super::run_out::RunOut;
use super::table::TableObservation;
use crate::calibration::result::InputFile;

/// Question to a distortion table.
#[derive(Debug, Clone)]
pub struct GridRequest<'a> {
    /// Name that messages use for the file of the table.
    pub file: String,
    /// Rows of the table.
    pub observations: &'a [TableObservation],
    /// Principal point at the calibrated position, mm.
    pub principal_point_mm: [f64; 2],
    /// Unit vector e of the FMC axis.
    pub axis: [f64; 2],
    /// Polynomial whose coefficients are kept unless they are estimated.
    pub lens: Lens,
    /// Coefficients of the polynomial that are estimated: K0 to K3, P1, P2, B1, B2.
    pub is_estimated: [bool; COEFFICIENTS],
    /// Run-out of the stage.
    pub run_out: RunOut,
    /// Grids, each with its nodes: none, one, or one of the lens and one of the sensor.
    pub grids: Vec<(GridCarrier, Lattice)>,
}

/// Question of `calibrate grid`.
#[derive(Debug, Clone)]
pub struct GridCalibrationRequest<'a> {
    /// File of the table.
    pub input: InputFile,
    /// Rows of the table.
    pub observations: &'a [TableObservation],
    /// Camera file: its principal distance, principal point, format, stroke and run-out are kept.
    pub camera: &'a CameraFile,
    /// Parts that have a grid: one, or lens and sensor.
    pub carriers: &'a [GridCarrier],
    /// Distance of neighbouring nodes, mm.
    pub pitch_mm: f64,
    /// Coefficients of the polynomial that are estimated: K0 to K3, P1, P2, B1, B2; the others are
    /// those of the camera file.
    pub is_estimated: [bool; COEFFICIENTS],
}
