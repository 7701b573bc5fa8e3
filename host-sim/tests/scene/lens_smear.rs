//! Smear that remains with perfect compensation: the distortion changes along the path of the image
//! under the lens.

use fmc_reference::exposure::ExposureRequest;
use fmc_reference::lens::Lens;
use fmc_simulation::scene::Scene;

use crate::scene::support::{HEIGHT_M, apart, points, published};

/// Error of neglecting the change of the gradient along the path, mm: δ²/2 times the distortion's
/// second derivative.
const SECOND_ORDER_MM: f64 = 1e-5;

#[test]
fn lens_smears_by_the_travel_times_the_gradient_of_its_distortion() {
    let mut most_mm = 0.0_f64;
    for camera in published() {
        let request = ExposureRequest::planned(0.17, 0.01);
        let scene = Scene::still(&camera, &request, HEIGHT_M);
        let frame = scene.expose(0.0);
        let travel_mm = camera.principal_distance_mm * 0.17 * 0.01;
        let lens = Lens::of(&camera);
        let [x0, y0] = frame.principal_point_mm();
        for [x, y] in points(&camera, 9, 0.98) {
            let ground = frame.ground_point([x, y]).unwrap();
            let found = frame.image_point(ground).unwrap().smear_mm;
            // p = q + D(p - c) with q at rest: dp = -(I - J)⁻¹·J·e·dc, in two steps J + J².
            let at = [x - x0, y - y0];
            let once = lens.derivative(at, camera.fmc.axis.unit());
            let twice = lens.derivative(at, once);
            let expected = [0, 1].map(|axis| -travel_mm * (once[axis] + twice[axis]));
            assert!(
                apart(found, expected) < SECOND_ORDER_MM,
                "{}: {found:?} {expected:?}",
                camera.name
            );
            most_mm = most_mm.max(found[0].hypot(found[1]));
        }
    }
    // The largest smear is that of the 50 mm lenses: δ = 87 µm times 1.9 %.
    assert!((most_mm - 1.68e-3).abs() < 0.01e-3, "{most_mm}");
}
