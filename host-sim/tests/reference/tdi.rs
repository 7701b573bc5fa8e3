//! TDI: the camera's staircase against the reference's, and the lag of docs/derivations/tdi.py.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera_file::number::single;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::strict::{StrictSolver, Weight};

use crate::reference::support::{STRONG_LENS, camera_distortion, largest, points, square};

#[test]
fn camera_and_reference_put_the_same_staircase_under_the_image() {
    for (first_transfer, shutter) in [
        (0.5, ""),
        (1.0, ""),
        (0.0, ""),
        (
            0.7,
            "[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n",
        ),
    ] {
        let camera = square(&format!(
            "{STRONG_LENS}[fmc]\nmechanism = \"tdi\"\nfirst_transfer = {first_transfer:.1}\n{shutter}"
        ));
        for (vh, t) in [(0.05, 0.001), (0.11, 0.0037), (0.17, 0.02)] {
            let request = ExposureRequest::planned(vh, t);
            let solver = StrictSolver::new(&camera, &request, Weight::Exposure);
            let exposure = Exposure::new(single(vh), single(t));
            for point in points(&camera).into_iter().step_by(17) {
                let strict = solver.mean(point.map(f64::from)).distortion_mm;
                let (found, left_out_mm) = camera_distortion(&camera, &exposure, point);
                // Single precision rounds 4 mm of distortion by 0.7 nm.
                assert!(
                    largest(found, strict) < left_out_mm + 7e-7,
                    "{first_transfer} {vh} {t}"
                );
            }
        }
    }
}

#[test]
fn late_first_transfer_lags_by_half_a_pixel() {
    let camera = square("[fmc]\nmechanism = \"tdi\"\nfirst_transfer = 1.0\n");
    // 20 whole rows of 8.75 µm: δ = 0.175 mm.
    let request = ExposureRequest::planned(0.1, 0.0175);
    let path = StrictSolver::new(&camera, &request, Weight::Exposure)
        .path()
        .clone();
    assert!((path.centroid_mm() - (0.0875 - 0.004_375)).abs() < 1e-9);
}

#[test]
fn opening_offset_moves_the_staircase_as_a_whole() {
    let camera = square(&format!(
        "{STRONG_LENS}[fmc]\nmechanism = \"tdi\"\nfirst_transfer = 1.0\n"
    ));
    let request = ExposureRequest {
        opening_offset_mm: Some(-0.3),
        ..ExposureRequest::planned(0.1, 0.0175)
    };
    let solver = StrictSolver::new(&camera, &request, Weight::Exposure);
    let exposure = Exposure {
        opening_offset_mm: Some(-0.3),
        ..Exposure::new(single(0.1), single(0.0175))
    };
    for point in points(&camera).into_iter().step_by(17) {
        let strict = solver.mean(point.map(f64::from)).distortion_mm;
        let (found, left_out_mm) = camera_distortion(&camera, &exposure, point);
        assert!(largest(found, strict) < left_out_mm + 7e-7);
    }
}
