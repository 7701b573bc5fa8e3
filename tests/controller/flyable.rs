//! The part of the default limits that a mechanism can fly.

use fmc_camera::flight::camera::{Camera, FrameError, Mechanism};
use fmc_camera::flight::controller::{Controller, ControllerError, Start};
use fmc_camera::flight::exposure::Limits;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::{CalibrationParameters, CameraParameters};

use crate::controller::bench::camera;

/// Returns a camera with a principal distance, a stroke and a largest speed of the stage.
fn staged(distance_mm: f32, stroke_mm: f32, max_speed_mm_s: Option<f32>) -> CameraParameters {
    let mut calibration = CalibrationParameters::new(distance_mm, [9216, 9216], 8.75);
    calibration.stroke_mm = stroke_mm;
    CameraParameters {
        mechanism: Mechanism::Stage {
            acceleration_mm_s2: 1000.0,
            settling_ms: 5.0,
            run_up: RunUp::Centred,
            jerk_mm_s3: None,
            max_speed_mm_s,
        },
        ..CameraParameters::new(calibration)
    }
}

fn settings(exposure_s: f32, trigger_interval_s: f32) -> FlightSettings {
    FlightSettings {
        exposure_s,
        trigger_interval_s,
        ..FlightSettings::default()
    }
}

fn start(camera: &CameraParameters, settings: &FlightSettings) -> Result<(), ControllerError> {
    PreparedCamera::new(Camera::new(*camera).unwrap(), settings, Start::Orderly).map(|_| ())
}

#[test]
fn mechanism_that_can_fly_the_limits_leaves_them_alone() {
    let camera = camera();
    assert_eq!(camera.limits, Limits::DEFAULT);
    for settings in [settings(1.0 / 300.0, 0.0), settings(1.0 / 300.0, 2.0)] {
        assert_eq!(Controller::flyable(&camera, &settings), camera);
        assert!(start(&camera, &settings).is_ok());
    }
}

#[test]
fn camera_that_was_refused_for_a_default_is_flown_up_to_what_its_mechanism_can() {
    // By speed, by stroke (50 mm/s: 1.25 mm of ramp and 0.25 mm of settling before the exposure),
    // and by time between triggers, 12 ms of which take up the play.
    for (camera, settings, expected) in [
        (staged(100.0, 4.0, Some(12.0)), settings(0.005, 1.0), 0.12),
        (staged(300.0, 4.0, None), settings(0.005, 1.0), 0.187),
        (staged(100.0, 4.0, None), settings(0.005, 0.12), 0.196),
    ] {
        let refused = start(&camera, &settings);
        assert!(
            matches!(refused, Err(ControllerError::Travel(_))),
            "{refused:?}"
        );
        let flown = Controller::flyable(&camera, &settings);
        let [least, most] = flown.limits.vh_per_s;
        assert_eq!(start(&flown, &settings), Ok(()));
        assert!((most - expected).abs() < 0.0015, "{most} for {expected}");
        // Nothing but the largest V/H changes, and a step more is refused.
        let mut more = flown;
        more.limits.vh_per_s = [least, most + 0.0012];
        assert!(start(&more, &settings).is_err(), "{most}");
        more.limits = camera.limits;
        assert_eq!(more, camera);
    }
}

#[test]
fn largest_vh_of_a_tdi_sensor_is_that_of_rows_and_stroke() {
    let tdi = |stroke_mm| CameraParameters {
        mechanism: Mechanism::Tdi {
            first_transfer: 0.5,
        },
        ..staged(1000.0, stroke_mm, None)
    };
    // 1024 rows of 8.75 µm in 1/30 s, and 2 mm from the calibrated place.
    for (stroke_mm, expected) in [(50.0, 1024.0 * 0.00875 * 30.0 / 1000.0), (4.0, 0.06)] {
        let settings = settings(1.0 / 30.0, 0.0);
        let flown = Controller::flyable(&tdi(stroke_mm), &settings);
        let most = flown.limits.vh_per_s[1];
        assert!(most <= expected && expected - most < 0.0012, "{most}");
    }
}

#[test]
fn camera_that_cannot_be_flown_at_all_stays_as_it_is_and_is_refused() {
    let camera = staged(300.0, 0.01, None);
    let settings = settings(0.005, 1.0);
    assert_eq!(Controller::flyable(&camera, &settings), camera);
    let refused = start(&camera, &settings);
    assert!(
        matches!(refused, Err(ControllerError::Travel(FrameError::Stroke(_)))),
        "{refused:?}"
    );
    let mut invalid = camera;
    invalid.calibration.principal_distance_mm = f32::NAN;
    let unchanged = Controller::flyable(&invalid, &settings);
    assert_eq!(unchanged.limits, invalid.limits);
}

#[test]
fn encoder_by_which_a_stage_may_be_off_by_its_stroke_is_refused_by_name() {
    let with_step = |stroke_mm, encoder_step_um| {
        let mut settings = settings(0.001, 0.0);
        settings.drive.encoder_step_um = encoder_step_um;
        start(&staged(100.0, stroke_mm, None), &settings)
    };
    assert_eq!(with_step(4.0, 100.0), Ok(()));
    // A twentieth of a millimetre: less 10 µm of tolerance, by 5, and half a micrometre.
    for (step_um, is_refused) in [(100.0, true), (8.6, true), (8.4, false)] {
        let refused = match with_step(0.05, step_um) {
            Err(ControllerError::Settings(error)) => Some(error),
            _ => None,
        };
        assert_eq!(refused.is_some(), is_refused, "{step_um}");
        if let Some(error) = refused {
            assert_eq!(error.quantity.name(), "encoder_step_um");
            assert!((error.max - 8.5).abs() < 1e-4, "{error}");
        }
    }
}
