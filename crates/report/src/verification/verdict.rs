//! The verdict in sentences.

use fmc_reference::strict::MAX_SOLVER_ERROR_NM;
use fmc_reference::verification::result::{
    CameraResult, MAX_COORDINATE_ERROR_NM, MAX_ERROR_NM, Treatment, Verification, WorstPoint,
};

use crate::{length, wording};

/// Result of a verification against the limits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Verdict {
    pub(super) passed: bool,
    /// Points, cameras, largest error and limit.
    pub(super) headline: String,
    /// Point with the largest error.
    pub(super) worst: Option<String>,
    /// Cameras that exceeded a limit, with that limit.
    pub(super) failures: Vec<String>,
}

impl Verdict {
    pub(super) fn of(verification: &Verification) -> Self {
        let passed = verification.passed();
        let cameras = wording::counted(verification.cameras.len(), "camera");
        let points = wording::count(verification.points());
        let worst = verification.worst();
        let headline = worst.map_or_else(
            || "no camera was verified".to_owned(),
            |camera| {
                let error = length::text(1e-6 * camera.worst.error_nm);
                format!("{points} coordinates of {cameras}, largest error {error}, limit {MAX_ERROR_NM} nm")
            },
        );
        Self {
            passed,
            headline,
            worst: worst.map(|camera| {
                let error = length::text(1e-6 * camera.worst.error_nm);
                format!("{}, {error} {}", camera.name, place(&camera.worst))
            }),
            failures: verification
                .difference
                .clone()
                .into_iter()
                .chain(verification.cameras.iter().filter_map(failure))
                .collect(),
        }
    }
}

/// Writes the limits in a sentence.
pub(super) fn limits() -> String {
    format!(
        "{MAX_ERROR_NM} nm on dx and dy, {MAX_COORDINATE_ERROR_NM} nm per axis on the corrected \
         coordinate, {MAX_SOLVER_ERROR_NM} nm on the strict solver's own error estimate"
    )
}

/// Writes point and exposure.
fn place(point: &WorstPoint) -> String {
    format!(
        "at x {:.3} mm, y {:.3} mm; V/H {}, exposure {}, {}",
        point.x_mm,
        point.y_mm,
        wording::vh(point.vh_per_s),
        wording::exposure(point.exposure_s),
        wording::strategy(point.strategy),
    )
}

/// Writes the limit that a camera exceeded, if it did not pass.
fn failure(camera: &CameraResult) -> Option<String> {
    if camera.passed() {
        return None;
    }
    let errors = [
        (
            "error of dx or dy",
            1e6 * camera.errors(Treatment::Camera).max_mm(),
            MAX_ERROR_NM,
            format!(" {}", place(&camera.worst)),
        ),
        (
            "error of a corrected coordinate",
            1e6 * camera.coordinate_errors().max_mm(),
            MAX_COORDINATE_ERROR_NM,
            String::new(),
        ),
        (
            "strict solver's own error estimate",
            1e6 * camera.solver_error_mm(),
            MAX_SOLVER_ERROR_NM,
            String::new(),
        ),
    ];
    let exceeded: Vec<String> = errors
        .iter()
        .filter(|(_, error_nm, limit_nm, _)| error_nm > limit_nm)
        .map(|(what, error_nm, limit_nm, place)| {
            let error = length::text(1e-6 * error_nm);
            format!("{what} {error} exceeds {limit_nm} nm{place}")
        })
        .collect();
    Some(if exceeded.is_empty() {
        format!("{}: not shown to be within the limits", camera.name)
    } else {
        format!("{}: {}", camera.name, exceeded.join("; "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    #[test]
    fn verdict_names_points_cameras_error_and_limit() {
        let verdict = Verdict::of(&fixture::passing());
        assert!(verdict.passed);
        assert!(verdict.failures.is_empty());
        assert_eq!(
            verdict.headline,
            "36 coordinates of 2 cameras, largest error 0.20 nm, limit 1.5 nm"
        );
    }

    #[test]
    fn failing_verdict_names_camera_point_and_exposure() {
        let verdict = Verdict::of(&fixture::failing());
        assert!(!verdict.passed);
        assert_eq!(
            verdict.failures,
            [
                "Beta: error of dx or dy 2.00 nm exceeds 1.5 nm at x 10.000 mm, y -5.000 mm; \
                 V/H 0.17 s⁻¹, exposure 1/100 s, run-up from rest"
            ]
        );
    }

    #[test]
    fn camera_that_differs_from_its_own_code_fails_whatever_the_errors() {
        let mut verification = fixture::passing();
        verification.difference = Some("Alpha: point 3 differs".to_owned());
        let verdict = Verdict::of(&verification);
        assert!(!verdict.passed);
        assert_eq!(verdict.failures, ["Alpha: point 3 differs"]);
    }

    #[test]
    fn verification_of_nothing_fails() {
        let verdict = Verdict::of(&fixture::of(Vec::new()));
        assert!(!verdict.passed);
        assert_eq!(verdict.headline, "no camera was verified");
    }

    #[test]
    fn solver_out_of_its_limit_is_named() {
        let mut verification = fixture::passing();
        verification.cameras[0].frames[0].solver_error_mm = 2e-8;
        let verdict = Verdict::of(&verification);
        assert!(verdict.failures[0].contains("strict solver's own error estimate 0.0200 nm"));
    }
}
