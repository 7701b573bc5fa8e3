//! Comparison of this camera with the strict solver.

use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_reference::strict::MAX_SOLVER_ERROR_NM;
use fmc_reference::verification::result::{MAX_COORDINATE_ERROR_NM, MAX_ERROR_NM, Treatment};
use serde::Serialize;

use super::inputs::Inputs;
use crate::stated::Stated;

/// Result of the camera's verification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proof {
    /// `true` if every point is within the limits.
    pub passed: bool,
    /// Device that computed.
    pub device: String,
    /// Points compared.
    pub points: u64,
    /// Exposures.
    pub exposures: u64,
    /// Exposures of the comparison that stroke or speed forbid.
    pub forbidden: u64,
    /// Smallest and largest V/H, 1/s.
    pub vh_per_s: [Option<Stated>; 2],
    /// Shortest and longest exposure, ms.
    pub exposure_ms: [Option<Stated>; 2],
    /// Smallest and largest δ, µm.
    pub travel_um: [Option<Stated>; 2],
    /// Largest error of dx or dy, nm.
    pub error_max_nm: Option<Stated>,
    /// Root mean square of the errors of dx and dy, nm.
    pub error_rms_nm: Option<Stated>,
    /// Limit of the largest error, nm.
    pub error_limit_nm: Option<Stated>,
    /// Place of the largest error, mm in the sensor frame.
    pub error_at_mm: [Option<Stated>; 2],
    /// Largest error of a corrected coordinate, nm.
    pub coordinate_max_nm: Option<Stated>,
    /// Limit of that error, nm.
    pub coordinate_limit_nm: Option<Stated>,
    /// Largest error of the static calibration in the same exposures, µm.
    pub static_max_um: Option<Stated>,
    /// Root mean square of it, µm.
    pub static_rms_um: Option<Stated>,
    /// Largest estimate of the strict solver's own error, nm.
    pub solver_error_nm: Option<Stated>,
    /// Limit of that estimate, nm.
    pub solver_limit_nm: Option<Stated>,
    /// Least scale ∂(ideal)/∂(measured) over the sensor enlarged by half the stroke: above zero the
    /// correction is one-to-one.
    pub least_scale: Option<Stated>,
}

impl Proof {
    /// Collects the figures of a verification.
    pub(super) fn new(inputs: &Inputs<'_>, grids: &CameraGrids<'_>) -> Self {
        let result = inputs.verification;
        // Nothing is known of an error that was not looked for.
        let is_checked = result.points > 0;
        let nm = |mm: f64| is_checked.then(|| Stated::decimals(1e6 * mm, 3)).flatten();
        let um = |mm: f64| is_checked.then(|| Stated::decimals(1e3 * mm, 3)).flatten();
        let ends = |value: &dyn Fn(usize) -> f64| {
            let values = || (0..result.frames.len()).map(value);
            [
                values().fold(f64::INFINITY, f64::min),
                values().fold(f64::NEG_INFINITY, f64::max),
            ]
        };
        let frame = |index: usize| result.frames.get(index);
        let vh = ends(&|index| frame(index).map_or(f64::NAN, |frame| frame.vh_per_s));
        let times = ends(&|index| frame(index).map_or(f64::NAN, |frame| frame.exposure_s));
        let camera = result.errors(Treatment::Camera);
        let at_rest = result.errors(Treatment::Static);
        let least_scale = f64::from(grids.least_scale());
        Self {
            passed: result.passed(),
            device: inputs.device.to_owned(),
            points: result.points,
            exposures: result.frames.len() as u64,
            forbidden: inputs.forbidden,
            vh_per_s: vh.map(|vh| Stated::digits(vh, 6)),
            exposure_ms: times.map(|time| Stated::digits(1e3 * time, 6)),
            travel_um: result.travel_mm().map(um),
            error_max_nm: nm(camera.max_mm()),
            error_rms_nm: nm(camera.rms_mm()),
            error_limit_nm: Stated::exact(MAX_ERROR_NM),
            error_at_mm: [result.worst.x_mm, result.worst.y_mm].map(|mm| {
                let stated = is_checked.then(|| Stated::decimals(mm, 3));
                stated.flatten()
            }),
            coordinate_max_nm: nm(result.coordinate_errors().max_mm()),
            coordinate_limit_nm: Stated::exact(MAX_COORDINATE_ERROR_NM),
            static_max_um: um(at_rest.max_mm()),
            static_rms_um: um(at_rest.rms_mm()),
            solver_error_nm: is_checked
                .then(|| Stated::digits(1e6 * result.solver_error_mm(), 2))
                .flatten(),
            solver_limit_nm: Stated::exact(MAX_SOLVER_ERROR_NM),
            least_scale: Stated::decimals(least_scale, 4),
        }
    }
}
