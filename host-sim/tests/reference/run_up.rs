//! Run-up with limited jerk and flight in both directions: the camera's plan against the
//! reference's own formula.

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::{Exposure, FlightDirection};
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_reference::exposure::{ExposurePath, ExposureRequest};
use fmc_reference::strict::{StrictSolver, Weight};

use crate::reference::support::{STRONG_LENS, camera_distortion, largest, points, square};

const DIRECTIONS: [FlightDirection; 2] = [FlightDirection::Forward, FlightDirection::Reverse];

const SHUTTER: &str =
    "[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n";

fn stage(strategy: &str, acceleration: f64, jerk: f64) -> CameraFile {
    square(&format!(
        "{STRONG_LENS}[fmc]\nstrategy = \"{strategy}\"\nstroke_mm = 10.0\nacceleration_mm_s2 = {acceleration:.1}\njerk_mm_s3 = {jerk:.1}\nmax_speed_mm_s = 60.0\n{SHUTTER}"
    ))
}

#[test]
fn opening_offset_is_the_references_to_a_nanometre() {
    let mut ramps = [0, 0];
    for strategy in ["centred", "from-rest"] {
        for acceleration in [100.0, 700.0, 1000.0, 20_000.0] {
            for jerk in [0.0, 1500.0, 1e4, 1e5, 3e6, 1e12] {
                let file = stage(strategy, acceleration, jerk);
                let camera = Camera::new(file.parameters()).unwrap();
                for vh in [0.05, 0.083, 0.11, 0.17] {
                    for t in [0.001, 0.0037, 0.02] {
                        for direction in DIRECTIONS {
                            let request = ExposureRequest {
                                direction,
                                ..ExposureRequest::planned(vh, t)
                            };
                            let exposure = Exposure {
                                direction,
                                ..Exposure::new(single(vh), single(t))
                            };
                            let path = ExposurePath::new(&file, &request);
                            // Run-up and stop of slow stages are longer than the stroke.
                            let Ok(plan) = camera.plan(&exposure) else {
                                assert!(acceleration <= 100.0 || (0.5..1e5).contains(&jerk));
                                continue;
                            };
                            let limit = acceleration * acceleration / jerk;
                            ramps[usize::from(
                                jerk > 0.0 && file.principal_distance_mm * vh < limit,
                            )] += 1;
                            // The tolerance is 1 nm, and the rounding of the request and of a few
                            // operations.
                            let offset = path.opening_offset_mm;
                            let tolerance = 1e-6 + 3e-7 * offset.abs();
                            let difference = f64::from(plan.opening_mm) - offset;
                            assert!(
                                difference.abs() <= tolerance,
                                "{strategy} a {acceleration} J {jerk} V/H {vh} t {t} {direction:?}: {difference} mm"
                            );
                            let travel = f64::from(plan.closing_mm - plan.opening_mm);
                            assert!((travel - path.travel_mm).abs() <= tolerance);
                        }
                    }
                }
            }
        }
    }
    // Both shapes of the ramp must occur often.
    assert!(ramps.iter().all(|count| *count > 100), "{ramps:?}");
}

#[test]
fn ramp_by_the_reference_is_the_integral_of_its_acceleration() {
    for (acceleration, jerk) in [(1000.0, 1e4), (1000.0, 1e5), (100.0, 1e4), (1000.0, 0.0)] {
        let file = stage("from-rest", acceleration, jerk);
        let path = ExposurePath::new(&file, &ExposureRequest::planned(0.17, 0.001));
        let speed = file.principal_distance_mm * 0.17;
        // The acceleration is integrated step by step up to half the speed. The other half of the
        // ramp is its mirror image, so that the ramp ends at v·T/2.
        let step = 1e-7;
        let (mut time, mut now, mut rate) = (0.0, 0.0_f64, 0.0_f64);
        while now < speed / 2.0 {
            let before = rate;
            rate = if jerk > 0.0 {
                (rate + jerk * step).min(acceleration)
            } else {
                acceleration
            };
            now += step
                * if jerk > 0.0 {
                    f64::midpoint(before, rate)
                } else {
                    rate
                };
            time += step;
        }
        let expected = speed * time + speed * 0.005;
        assert!(
            (path.opening_offset_mm - expected).abs() < 1e-5,
            "{acceleration} {jerk}: {} mm, {expected} mm",
            path.opening_offset_mm
        );
    }
}

#[test]
fn reverse_flight_is_corrected_as_the_strict_solver_says() {
    let tdi = format!("{STRONG_LENS}[fmc]\nmechanism = \"tdi\"\nfirst_transfer = 1.0\n{SHUTTER}");
    for camera in [
        stage("centred", 1000.0, 1e5),
        stage("from-rest", 1000.0, 1e5),
        square(&tdi),
    ] {
        for (vh, t) in [(0.05, 0.001), (0.11, 0.0037), (0.17, 0.02)] {
            let request = ExposureRequest {
                direction: FlightDirection::Reverse,
                ..ExposureRequest::planned(vh, t)
            };
            let solver = StrictSolver::new(&camera, &request, Weight::Exposure);
            assert!(solver.path().travel_mm < 0.0);
            let exposure = Exposure {
                direction: FlightDirection::Reverse,
                ..Exposure::new(single(vh), single(t))
            };
            for point in points(&camera).into_iter().step_by(17) {
                let strict = solver.mean(point.map(f64::from)).distortion_mm;
                let (found, left_out_mm) = camera_distortion(&camera, &exposure, point);
                // Single precision rounds 4 mm of distortion by 0.7 nm.
                assert!(
                    largest(found, strict) < left_out_mm + 7e-7,
                    "{vh} {t}: {} nm",
                    1e6 * largest(found, strict)
                );
            }
        }
    }
}
