//! The verification for programs: `summary.json`.

use fmc_camera::io::link::message::Counters;
use fmc_reference::strict::MAX_SOLVER_ERROR_NM;
use fmc_reference::verification::result::{
    CameraResult, ErrorStatistics, MAX_COORDINATE_ERROR_NM, MAX_ERROR_NM, Treatment, Verification,
    WorstPoint,
};
use serde::Serialize;

/// The numbers of a verification. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Device that computed the corrections; if it stands in for QEMU, with the reason.
    pub device: String,
    /// Points compared.
    pub points: u64,
    /// Points shown by a digest of the camera to have the bits computed on this PC.
    pub points_by_digest: u64,
    /// Points that the camera itself answered.
    pub points_by_value: u64,
    /// Counters of the camera's end of the link; null without a link.
    pub link: Option<Counters>,
    /// Difference between the camera and its own code on this PC; null if there is none.
    pub difference: Option<String>,
    /// `true` if every camera is within the limits.
    pub passed: bool,
    /// The limits.
    pub limits: Limits,
    /// Largest error of dx or dy, nm.
    pub max_error_nm: f64,
    /// Root mean square error of dx and dy, nm.
    pub rms_error_nm: f64,
    /// Mean error of dx and dy, nm.
    pub bias_nm: f64,
    /// Largest error of a corrected coordinate, per axis, nm.
    pub coordinate_max_nm: f64,
    /// Largest error estimate of the strict solver, nm.
    pub solver_error_nm: f64,
    /// Point with the largest error; null without cameras.
    pub worst: Option<Worst>,
    /// Results of every camera.
    pub cameras: Vec<CameraSummary>,
    /// Reason and remedy if the device should have been QEMU and was not; null otherwise.
    pub not_in_qemu: Option<String>,
}

/// The limits, nm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Limit of the error of dx and dy.
    pub max_error_nm: f64,
    /// Limit of the error of a corrected coordinate.
    pub coordinate_max_nm: f64,
    /// Limit of the error estimate of the strict solver.
    pub solver_error_nm: f64,
}

/// The point with the largest error of all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worst {
    /// Name of the camera.
    pub camera: String,
    /// Point and exposure.
    #[serde(flatten)]
    pub point: WorstPoint,
}

/// The numbers of one camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CameraSummary {
    /// Name in the camera file.
    pub name: String,
    /// Points compared.
    pub points: u64,
    /// `true` if the camera is within the limits.
    pub passed: bool,
    /// Largest error of dx or dy, nm.
    pub max_error_nm: f64,
    /// Root mean square error of dx and dy, nm.
    pub rms_error_nm: f64,
    /// Mean error of dx and dy, nm.
    pub bias_nm: f64,
    /// Largest error of a corrected coordinate, per axis, nm.
    pub coordinate_max_nm: f64,
    /// Largest error estimate of the strict solver, nm.
    pub solver_error_nm: f64,
    /// Largest error without any correction, µm.
    pub uncorrected_max_um: f64,
    /// Root mean square error without any correction, µm.
    pub uncorrected_rms_um: f64,
    /// Largest error of the static correction, µm.
    pub static_max_um: f64,
    /// Root mean square error of the static correction, µm.
    pub static_rms_um: f64,
    /// Largest error of the static correction plus eqs. 20-21 as printed, µm.
    pub printed_max_um: f64,
    /// Root mean square error of the static correction plus eqs. 20-21 as printed, µm.
    pub printed_rms_um: f64,
    /// Smallest and largest δ, µm.
    pub delta_um: [f64; 2],
    /// Smallest and largest length of the distortion, µm.
    pub distortion_um: [f64; 2],
    /// Point with the largest error.
    pub worst: WorstPoint,
}

impl Summary {
    /// Returns the summary of a verification.
    #[must_use]
    pub fn of(verification: &Verification) -> Self {
        let mut errors = ErrorStatistics::default();
        let mut coordinate = ErrorStatistics::default();
        let mut solver_error_mm = 0.0_f64;
        for camera in &verification.cameras {
            errors.merge(&camera.errors(Treatment::Camera));
            coordinate.merge(&camera.coordinate_errors());
            solver_error_mm = solver_error_mm.max(camera.solver_error_mm());
        }
        Self {
            device: verification.place(),
            points: verification.points(),
            points_by_digest: verification.evidence.by_digest,
            points_by_value: verification.evidence.by_value,
            link: verification.link,
            difference: verification.difference.clone(),
            passed: verification.passed(),
            limits: Limits {
                max_error_nm: MAX_ERROR_NM,
                coordinate_max_nm: MAX_COORDINATE_ERROR_NM,
                solver_error_nm: MAX_SOLVER_ERROR_NM,
            },
            max_error_nm: 1e6 * errors.max_mm(),
            rms_error_nm: 1e6 * errors.rms_mm(),
            bias_nm: 1e6 * errors.bias_mm(),
            coordinate_max_nm: 1e6 * coordinate.max_mm(),
            solver_error_nm: 1e6 * solver_error_mm,
            worst: verification.worst().map(|camera| Worst {
                camera: camera.name.clone(),
                point: camera.worst.clone(),
            }),
            cameras: verification.cameras.iter().map(CameraSummary::of).collect(),
            not_in_qemu: verification.not_in_qemu.clone(),
        }
    }
}

impl CameraSummary {
    fn of(camera: &CameraResult) -> Self {
        let [uncorrected, fixed, printed, corrected] =
            Treatment::ALL.map(|treatment| camera.errors(treatment));
        Self {
            name: camera.name.clone(),
            points: camera.points,
            passed: camera.passed(),
            max_error_nm: 1e6 * corrected.max_mm(),
            rms_error_nm: 1e6 * corrected.rms_mm(),
            bias_nm: 1e6 * corrected.bias_mm(),
            coordinate_max_nm: 1e6 * camera.coordinate_errors().max_mm(),
            solver_error_nm: 1e6 * camera.solver_error_mm(),
            uncorrected_max_um: 1e3 * uncorrected.max_mm(),
            uncorrected_rms_um: 1e3 * uncorrected.rms_mm(),
            static_max_um: 1e3 * fixed.max_mm(),
            static_rms_um: 1e3 * fixed.rms_mm(),
            printed_max_um: 1e3 * printed.max_mm(),
            printed_rms_um: 1e3 * printed.rms_mm(),
            delta_um: camera.travel_mm().map(|mm| 1e3 * mm),
            distortion_um: camera.distortion_mm.map(|mm| 1e3 * mm),
            worst: camera.worst.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    #[test]
    fn summary_has_the_promised_keys() {
        let json = serde_json::to_value(Summary::of(&fixture::passing())).unwrap();
        for key in [
            "device",
            "points",
            "points_by_digest",
            "points_by_value",
            "max_error_nm",
            "cameras",
            "passed",
            "worst",
            "not_in_qemu",
        ] {
            assert!(json.get(key).is_some(), "{key} is missing");
        }
        let keys = [
            "name",
            "points",
            "max_error_nm",
            "rms_error_nm",
            "static_max_um",
            "printed_max_um",
        ];
        for key in keys {
            assert!(json["cameras"][1].get(key).is_some(), "{key} is missing");
        }
        assert_eq!(json["points"], 36);
        assert_eq!(json["worst"]["camera"], "Beta");
    }

    #[test]
    fn units_are_those_the_keys_name() {
        let summary = Summary::of(&fixture::passing());
        assert!((summary.max_error_nm - 0.2).abs() < 1e-9);
        let alpha = &summary.cameras[0];
        assert!((alpha.max_error_nm - 0.1).abs() < 1e-9);
        assert!((alpha.static_max_um - 0.5).abs() < 1e-9);
        assert!((alpha.delta_um[1] - 80.0).abs() < 1e-9);
    }

    #[test]
    fn failing_verification_says_so() {
        let json = serde_json::to_value(Summary::of(&fixture::failing())).unwrap();
        assert_eq!(json["passed"], false);
        assert_eq!(json["cameras"][0]["passed"], true);
        assert_eq!(json["cameras"][1]["passed"], false);
    }
}
