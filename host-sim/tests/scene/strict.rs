//! Still air, flat ground and perfect compensation, for which the strict solver is exact.

use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera_file::CameraFile;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::strict::{StrictSolver, Weight};
use fmc_simulation::scene::Scene;

use crate::scene::support::{HEIGHT_M, apart, ground_below, points, published, square};

/// Largest distance of the exposure from the solver that follows the image, mm.
const FOLLOWED_MM: f64 = 1e-8;
/// Largest distance from the solver's own mean, which stays at the measured point, mm. That
/// approximation of the solver costs up to 0.0106 nm over the published cameras.
const FIXED_MM: f64 = 1.1e-8;

/// Returns the differences from the solver: (following the image, at the fixed measured point), mm.
fn differences(camera: &CameraFile, request: &ExposureRequest) -> (f64, f64) {
    let scene = Scene::still(camera, request, HEIGHT_M);
    let frame = scene.expose(0.3);
    let solver = StrictSolver::new(camera, request, Weight::Exposure);
    let mut followed = 0.0_f64;
    let mut fixed = 0.0_f64;
    for measured in points(camera, 7, 0.98) {
        let [dx, dy] = solver.mean(measured).distortion_mm;
        let ideal = [measured[0] - dx, measured[1] - dy];
        let ground = ground_below(&scene, &frame, ideal);
        let found = frame.image_point(ground).unwrap();
        assert!(apart(found.smear_mm, [0.0; 2]) < 1.0);
        fixed = fixed.max(apart(found.point_mm, measured));
        followed = followed.max(apart(found.point_mm, followed_mean(&solver, ideal)));
    }
    (followed, fixed)
}

/// Returns the mean place of an ideal point's image: at every instant the point from which the
/// solver's distortion leads back to the ideal one. Simpson's rule between the shutter's corners.
fn followed_mean(solver: &StrictSolver, [x, y]: [f64; 2]) -> [f64; 2] {
    let place = |u: f64| {
        let mut at = [x, y];
        for _ in 0..40 {
            let [dx, dy] = solver.distortion(at, u);
            at = [x + dx, y + dy];
        }
        at
    };
    let path = solver.path();
    let (mut light, mut sum) = (0.0, [0.0; 2]);
    let intervals = 20_u8;
    for edges in path.nodes().windows(2) {
        let step = (edges[1] - edges[0]) / f64::from(intervals);
        for index in 0..=intervals {
            let u = edges[0] + step * f64::from(index);
            let simpson = match index {
                0 | 20 => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let weight = simpson * step * path.transmission(u.min(1.0));
            // An interval of length zero may begin where the transmission is undefined.
            if weight > 0.0 {
                light += weight;
                let [px, py] = place(u);
                sum = [sum[0] + weight * px, sum[1] + weight * py];
            }
        }
    }
    sum.map(|part| part / light)
}

#[test]
fn published_cameras_agree_with_the_strict_solver() {
    let (mut followed, mut fixed) = (0.0_f64, 0.0_f64);
    for camera in published() {
        for vh_per_s in [0.05, 0.17] {
            for exposure_s in [1.0 / 700.0, 1.0 / 100.0] {
                let request = ExposureRequest::planned(vh_per_s, exposure_s);
                let (of_followed, of_fixed) = differences(&camera, &request);
                followed = followed.max(of_followed);
                fixed = fixed.max(of_fixed);
            }
        }
    }
    assert!(followed <= FOLLOWED_MM, "{followed}");
    assert!(fixed <= FIXED_MM, "{fixed}");
}

#[test]
fn ramps_run_out_focus_and_every_axis_agree_with_the_strict_solver() {
    for axis in ["+x", "-x", "+y", "-y"] {
        let camera = square(&format!(
            "[distortion]\nk0 = 2e-4\nk1 = -2e-6\nk2 = 6e-10\np1 = 2e-6\np2 = -3e-6\nb1 = 1e-4\n\
             b2 = -5e-5\n[fmc]\naxis = \"{axis}\"\nstrategy = \"from-rest\"\n\
             flatness_um = [1.0, 20.0, -8.0]\n[shutter]\nprofile = \"trapezoid\"\n\
             opening_fraction = 0.3\nclosing_fraction = 0.1\n"
        ));
        let request = ExposureRequest {
            focus_shift_mm: 0.004,
            ..ExposureRequest::planned(0.17, 0.01)
        };
        for direction in [FlightDirection::Forward, FlightDirection::Reverse] {
            let request = ExposureRequest {
                direction,
                ..request
            };
            let (followed, _) = differences(&camera, &request);
            assert!(followed <= FOLLOWED_MM, "{axis} {direction:?}: {followed}");
        }
    }
}

#[test]
fn rows_of_a_tdi_sensor_lag_as_the_strict_solver_says() {
    let camera = square(
        "[distortion]\nk1 = -2e-6\n[fmc]\nmechanism = \"tdi\"\nfirst_transfer = 1.0\n\
         [shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.2\nclosing_fraction = 0.1\n",
    );
    for direction in [FlightDirection::Forward, FlightDirection::Reverse] {
        let request = ExposureRequest {
            direction,
            ..ExposureRequest::planned(0.13, 0.01)
        };
        let (_, fixed) = differences(&camera, &request);
        assert!(fixed <= FIXED_MM, "{direction:?}: {fixed}");
    }
}
