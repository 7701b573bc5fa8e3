//! The interpolated truth against the solver.

use fastrand::Rng;
use fmc_rectification::truth::TrueGeometry;
use fmc_reference::exposure::ExposureRequest;

use crate::cameras::{Case, published_in_flight, random};

/// Largest difference of the interpolated distortion from the solver's, px.
const LARGEST_PX: f64 = 1e-5;

/// Returns the true map of a case.
pub(crate) fn truth(case: &Case) -> TrueGeometry {
    let [vh_per_s, exposure_s] = case.exposure.map(f64::from);
    TrueGeometry::new(&case.file, &ExposureRequest::planned(vh_per_s, exposure_s))
}

#[test]
fn the_truth_between_corners_is_the_solver_s() {
    let mut rng = Rng::with_seed(11);
    let mut cases: Vec<Case> = (0..4).map(|_| random(&mut rng, 4000)).collect();
    cases.extend(published_in_flight().into_iter().step_by(5));
    let mut largest = 0.0_f64;
    for case in &cases {
        let truth = truth(case);
        let half = case.file.half_format_mm();
        let pixel_mm = case.file.sensor.pixel_um / 1000.0;
        for _ in 0..40 {
            let point = half.map(|half| half * (2.0 * rng.f64() - 1.0));
            let (found, exact) = (
                truth.distortion_mm(point),
                truth.strict_distortion_mm(point),
            );
            let error = (found[0] - exact[0]).hypot(found[1] - exact[1]) / pixel_mm;
            assert!(error <= LARGEST_PX, "{}: {error}", case.name);
            largest = largest.max(error);
            let back = truth.measured_mm(truth.ideal_mm(point));
            let error = (back[0] - point[0]).hypot(back[1] - point[1]) / pixel_mm;
            assert!(error <= 1e-9, "{}: {error} px back", case.name);
        }
        let [x, y] = truth.principal_point_mm();
        let of_camera = case.principal_point;
        let error = (x - f64::from(of_camera.x_mm)).hypot(y - f64::from(of_camera.y_mm));
        // Single precision of a millimetre or so.
        assert!(error <= 1e-6, "{}: {error} mm", case.name);
    }
    println!("{largest}");
}
