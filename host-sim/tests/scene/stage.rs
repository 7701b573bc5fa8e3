//! Faults of the stage, against estimates by hand.

use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_reference::exposure::ExposureRequest;
use fmc_simulation::scene::Scene;
use fmc_simulation::scene::stage::Encoder;
use fmc_simulation::scene::stage_path::StagePath;
use fmc_simulation::scene::turbulence::{Spectrum, Turbulence};

use crate::scene::support::{HEIGHT_M, apart, points, square};

const EXPOSURE_S: f64 = 0.01;

/// Returns a scene with a travel of f·η·t = 0.1 mm.
fn scene(camera: &CameraFile) -> Scene {
    Scene::still(camera, &ExposureRequest::planned(0.1, EXPOSURE_S), HEIGHT_M)
}

#[test]
fn stage_too_fast_smears_by_its_error_and_moves_the_centroid_by_half() {
    let camera = square("");
    let right = scene(&camera);
    let mut fast = right.clone();
    fast.stage.speed_error_percent = 2.0;
    let (right, fast) = (right.expose(0.0), fast.expose(0.0));
    for point in points(&camera, 5, 0.9) {
        let ground = right.ground_point(point).unwrap();
        let [before, after] = [&right, &fast].map(|frame| frame.image_point(ground).unwrap());
        // The smear is 2 % of 0.1 mm along +y. It starts at the opening, so that the centroid moves
        // by half.
        assert!(apart(after.smear_mm, [0.0, 0.002]) < 1e-10);
        let [x, y] = before.point_mm;
        assert!(apart(after.point_mm, [x, y + 0.001]) < 1e-10);
    }
    assert!((fast.centroid_offset_mm() - 0.001).abs() < 1e-12);
}

/// Returns the error of c̄ that the camera computes from the encoder's readings, µm. Readings are 1
/// µm of travel apart.
fn centroid_error_um(scene: &mut Scene, step_um: f64, phase_um: f64) -> f64 {
    scene.stage.encoder = Encoder {
        step_um,
        phase_um,
        rate_hz: 10_000.0,
    };
    let frame = scene.expose(0.0);
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let samples = frame.encoder_samples();
    let measured =
        PrincipalPointMotion::from_samples(&samples, single(EXPOSURE_S), &shutter).unwrap();
    1e3 * (f64::from(measured.centroid_mm) - frame.centroid_offset_mm())
}

#[test]
fn many_encoder_steps_average_out_to_half_the_distance_of_readings() {
    let mut scene = scene(&square(""));
    // The travel has 20 steps of 5 µm with five readings to a step, so the error depends on the
    // place of the readings within a step.
    let most_um = (0..100)
        .map(|phase| centroid_error_um(&mut scene, 5.0, 0.05 * f64::from(phase)).abs())
        .fold(0.0, f64::max);
    assert!(most_um > 0.4 && most_um < 0.501, "{most_um}");
}

#[test]
fn few_encoder_steps_err_as_a_rounded_ramp_does() {
    let mut scene = scene(&square(""));
    // With a step four times the travel, the reading is the phase while no edge comes into -50 … 50
    // µm.
    for phase_um in [-149.0, -40.0, 0.0, 75.0, 149.0] {
        let error = centroid_error_um(&mut scene, 400.0, phase_um);
        assert!((error - phase_um).abs() < 1e-3, "{phase_um}: {error}");
    }
    // Over all phases: the mean of a sawtooth of period q over the travel δ < q has the standard
    // deviation (q/√12)(1 - δ/q), 86.6 µm.
    let phases = 400_u16;
    let mean_square = (0..phases)
        .map(|phase| centroid_error_um(&mut scene, 400.0, f64::from(phase)).powi(2))
        .sum::<f64>()
        / f64::from(phases);
    let expected_um = 400.0 / 12.0_f64.sqrt() * 0.75;
    assert!((mean_square.sqrt() / expected_um - 1.0).abs() < 1e-3);
}

#[test]
fn run_out_enlarges_the_image_by_its_mean_and_smears_by_its_range() {
    let mut bent = scene(&square("[fmc]\nflatness_um = [2.0, 30.0, 40.0]\n"));
    bent.stage.opening_offset_mm = 0.3;
    let mut flat = bent.clone();
    flat.stage.flatness_um = vec![0.0];
    let (bent, flat) = (bent.expose(0.0), flat.expose(0.0));
    // s from 0.3 to 0.4 mm; L = 100 mm.
    let mean_um = 2.0 + 30.0 * 0.35 + 40.0 * (0.35_f64.powi(2) + 0.1_f64.powi(2) / 12.0);
    let range_um = 30.0 * 0.1 + 40.0 * (0.4_f64.powi(2) - 0.3_f64.powi(2));
    let [mean, range] = [mean_um, range_um].map(|um| 1e-3 * um / 100.0);
    let [x0, y0] = flat.principal_point_mm();
    for point in points(&square(""), 5, 0.9) {
        let ground = flat.ground_point(point).unwrap();
        let [without, with] = [&flat, &bent].map(|frame| frame.image_point(ground).unwrap());
        let [x, y] = without.point_mm;
        // The estimate omits the covariance of run-out and place, 58 µm/mm·δ²/12/L = 0.5 nm.
        let enlarged = [x + (x - x0) * mean, y + (y - y0) * mean];
        assert!(apart(with.point_mm, enlarged) < 1e-6);
        // Under the lens the image moves against the principal point by δ.
        let smeared = [(x - x0) * range, (y - y0) * range - 0.1 * mean];
        assert!(apart(with.smear_mm, smeared) < 1e-6);
    }
}

#[test]
fn turbulence_smears_by_what_it_turns_the_camera() {
    let mut scene = scene(&square(""));
    let spectrum = Spectrum {
        rms: 1.0,
        corner_hz: 1.0,
    };
    for (seed, process) in (40..).zip(&mut scene.attitude.turbulence) {
        *process = Turbulence::new(spectrum, seed);
    }
    let exposures = 200_u8;
    let mut sum = 0.0;
    for index in 0..exposures {
        let opening_s = 0.7 * f64::from(index);
        // The camera is level at the centroid.
        scene.attitude.reference_s = opening_s + EXPOSURE_S / 2.0;
        let frame = scene.expose(opening_s);
        let ground = frame.ground_point([0.0, 0.0]).unwrap();
        let [x, y] = frame.image_point(ground).unwrap().smear_mm;
        let [pitch, roll, _] = scene.attitude.turbulence.each_ref().map(|process| {
            let turned = process.integral(opening_s + EXPOSURE_S) - process.integral(opening_s);
            turned.to_radians()
        });
        // In the middle of the image the smear is f times the angle: nose up moves the image back,
        // right side down to the right. The estimate omits the yaw times the motion under the lens,
        // 0.05 mm times 1e-4.
        assert!(apart([x, y], [100.0 * roll, -100.0 * pitch]) < 1e-5);
        sum += x * x + y * y;
    }
    // Two axes of 1 °/s: f·t·√2·0.01745 = 24.7 µm.
    let rms_um = 1e3 * (sum / f64::from(exposures)).sqrt();
    assert!((rms_um / 24.7 - 1.0).abs() < 0.1, "{rms_um}");
}

#[test]
fn recorded_path_of_constant_speed_is_constant_speed_and_a_step_moves_what_comes_after_it() {
    let camera = square("");
    let constant = scene(&camera);
    let mut recorded = constant.clone();
    let at = |time: f64| constant.stage.offset_mm(time);
    let straight = |times: &[f64]| times.iter().map(|time| (*time, at(*time))).collect();
    recorded.stage.path = StagePath::new(straight(&[-0.001, 0.0033, 0.0071, 0.011]));
    let (one, other) = (constant.expose(0.0), recorded.expose(0.0));
    assert!((one.centroid_offset_mm() - other.centroid_offset_mm()).abs() < 1e-13);
    let ground = one.ground_point([20.0, -10.0]).unwrap();
    let [before, after] = [&one, &other].map(|frame| frame.image_point(ground).unwrap());
    assert!(apart(before.point_mm, after.point_mm) < 1e-12);
    assert!(apart(before.smear_mm, after.smear_mm) < 1e-12);

    // The stage is 8 µm ahead from a quarter of the exposure on, for three quarters of the light.
    let quarter = 0.25 * EXPOSURE_S;
    let mut knots: Vec<(f64, f64)> = straight(&[0.0, quarter]);
    knots.push((quarter + 1e-9, at(quarter + 1e-9) + 0.008));
    knots.push((EXPOSURE_S, at(EXPOSURE_S) + 0.008));
    recorded.stage.path = StagePath::new(knots);
    let stepped = recorded.expose(0.0);
    let moved_mm = stepped.centroid_offset_mm() - one.centroid_offset_mm();
    assert!((moved_mm - 0.006).abs() < 1e-9, "{moved_mm}");
    assert!(apart(stepped.image_point(ground).unwrap().smear_mm, [0.0, 0.008]) < 1e-9);
}
