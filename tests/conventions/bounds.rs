//! Last column of section 10: bounds that follow from other quantities.

use crate::conventions::camera;
use fmc_camera::flight::camera::{Camera, CameraParameters, FrameError};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::stage::StrokeTooShort;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::image_motion::{
    FlightState, ImageMotion, ImageMotionError, LEAST_GROUND_SCALE, View,
};
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera::geometry::range::{MAX_FOCUS_FRACTION, OutOfRange, Quantity};
use fmc_camera::geometry::sensor::MAX_SIDE_MM;
use fmc_camera::geometry::shutter::ShutterProfile;

fn camera_with(change: impl Fn(&mut CameraParameters)) -> Result<Camera, CalibrationError> {
    let mut record = camera::record();
    change(&mut record);
    Camera::new(record)
}

fn refusal(change: impl Fn(&mut CameraParameters)) -> OutOfRange {
    match camera_with(change) {
        Err(CalibrationError::OutOfRange(error)) => error,
        other => panic!("not refused: {other:?}"),
    }
}

fn assert_near(value: f32, expected: f32) {
    assert!(
        (value - expected).abs() <= 1e-6 * expected.abs(),
        "{value} is not {expected}"
    );
}

#[test]
fn principal_point_lies_on_the_array() {
    let half_side_mm = 9216.0 * 0.008_75 / 2.0;
    let x = refusal(|record| record.calibration.principal_point.x_mm = 41.0);
    assert_eq!(x.quantity, Quantity::PrincipalPointX);
    assert_near(x.max, half_side_mm);
    let y = refusal(|record| record.calibration.principal_point.y_mm = -41.0);
    assert_eq!(y.quantity, Quantity::PrincipalPointY);
    assert_near(y.min, -half_side_mm);
}

#[test]
fn sides_end_at_the_last_whole_pixel_within_the_longest_side() {
    let most_px = 57_142_u16;
    let pixel_mm = 0.008_75_f32;
    assert!(f32::from(most_px) * pixel_mm <= MAX_SIDE_MM);
    assert!(f32::from(most_px + 1) * pixel_mm > MAX_SIDE_MM);
    let width = refusal(|record| record.calibration.width_px = u32::from(most_px) + 1);
    assert_eq!(width.quantity, Quantity::WidthPx);
    assert_near(width.max, most_px.into());
    let height = refusal(|record| record.calibration.height_px = u32::from(most_px) + 1);
    assert_eq!(height.quantity, Quantity::HeightPx);
    assert_near(height.max, most_px.into());
    assert!(camera_with(|record| record.calibration.width_px = most_px.into()).is_ok());
}

#[test]
fn ramps_fit_the_exposure() {
    let ramps = refusal(|record| {
        record.shutter = ShutterProfile::Trapezoid {
            opening_fraction: 0.3,
            closing_fraction: 0.8,
        };
    });
    assert_eq!(ramps.quantity, Quantity::ClosingFraction);
    assert_near(ramps.max, 1.0 - 0.3);
}

#[test]
fn flatness_is_bounded_term_by_term_at_half_the_stroke() {
    let bent = refusal(|record| record.calibration.flatness.coefficients_um[2] = 600.0);
    assert_eq!(bent.quantity, Quantity::FlatnessUm);
    assert_near(bent.value, 600.0 * 2.0 * 2.0);
}

#[test]
fn focus_shift_is_bounded_by_both_distances_with_every_model() {
    for (principal_distance_mm, exit_pupil_mm) in [(100.0, 50.0), (50.0, 100.0)] {
        let camera = camera_with(|record| {
            record.calibration.principal_distance_mm = principal_distance_mm;
            record.calibration.exit_pupil_mm = exit_pupil_mm;
        })
        .unwrap();
        for model in [
            CorrectionModel::Exact,
            CorrectionModel::Fitted,
            CorrectionModel::Static,
        ] {
            let defocused = Exposure {
                focus_shift_um: 501.0,
                model,
                ..Exposure::new(0.1, 0.01)
            };
            let Err(FrameError::OutOfRange(error)) = camera.frame(&defocused) else {
                panic!("not refused");
            };
            assert_eq!(error.quantity, Quantity::FocusShiftUm);
            assert_near(error.max, MAX_FOCUS_FRACTION * 50.0 * 1000.0);
        }
    }
}

#[test]
fn given_opening_and_the_closing_lie_within_half_the_stroke() {
    let exposure = Exposure {
        opening_offset_mm: Some(1.95),
        ..Exposure::new(0.1, 0.01)
    };
    let camera = Camera::new(camera::record()).unwrap();
    let Err(FrameError::Stroke(error)) = camera.frame(&exposure) else {
        panic!("not refused");
    };
    let StrokeTooShort {
        from_mm,
        to_mm,
        half_stroke_mm,
    } = error;
    assert_near(from_mm, 1.95);
    assert_near(to_mm, 1.95 + 100.0 * 0.1 * 0.01);
    assert_near(half_stroke_mm, 2.0);
}

#[test]
fn centroid_of_a_measured_motion_lies_within_half_the_stroke() {
    let exposure = Exposure::new(0.1, 0.01);
    let camera = Camera::new(camera::record()).unwrap();
    let motion = PrincipalPointMotion {
        centroid_mm: 2.01,
        ..camera.motion(&exposure).unwrap()
    };
    let Err(FrameError::OutOfRange(error)) = camera.frame_of(&exposure, &motion) else {
        panic!("not refused");
    };
    assert_eq!(error.quantity, Quantity::CentroidOffsetMm);
    assert_near(error.max, 2.0);
}

#[test]
fn pitch_and_roll_keep_the_horizon_off_the_sensor() {
    let mut record = camera::record();
    record.calibration.principal_distance_mm = 36.0;
    let camera = Camera::new(record).unwrap();
    let view = View::calibrated(camera.calibration());
    // Least scale: cosθ - (40.32/36)·sinθ, and the same for a roll alone.
    for (degrees, scale) in [(36.0_f32, 0.150_7_f32), (40.0, 0.046_1)] {
        let mut tilted = [FlightState::default(); 2];
        tilted[0].attitude.pitch_deg = degrees;
        tilted[1].attitude.roll_deg = -degrees;
        for flight in tilted {
            match ImageMotion::new(&view, &flight) {
                Ok(_) => assert!(scale >= LEAST_GROUND_SCALE),
                Err(ImageMotionError::Horizon(found)) => {
                    assert!(scale < LEAST_GROUND_SCALE);
                    assert!((found - scale).abs() < 1e-4, "{found}");
                }
                Err(error) => panic!("{error}"),
            }
        }
    }
}
