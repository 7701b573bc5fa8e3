//! Round trips: `distort` is the inverse of `correct`, or an error.

use crate::geometry::cameras;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use proptest::prelude::*;

/// Units in the last place of the larger of measured and ideal coordinate.
const LIMIT_ULPS: f32 = 2.0;
/// Error near an axis of the sensor, nm, where a unit in the last place is less than the effect of
/// the *other* coordinate's rounding on the distortion.
const LIMIT_NEAR_AXIS_NM: f32 = 0.02;

/// Returns true if a point comes back.
fn comes_back(correction: &FrameCorrection, measured: SensorPoint) -> bool {
    let ideal = correction.correct(measured).point;
    let back = correction
        .distort(ideal)
        .unwrap_or_else(|error| panic!("{measured:?}: {error}"))
        .point;
    let within = |a: f32, ideal: f32, b: f32| {
        let largest = a.abs().max(ideal.abs());
        let ulp = largest.next_up() - largest;
        (a - b).abs() <= (LIMIT_ULPS * ulp).max(LIMIT_NEAR_AXIS_NM * 1e-6)
    };
    within(measured.x_mm, ideal.x_mm, back.x_mm) && within(measured.y_mm, ideal.y_mm, back.y_mm)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn every_model_of_any_lens_comes_back_within_two_ulps(
        lens in cameras::lenses(),
        axis in cameras::axes(),
        motion in cameras::motions(),
        shift_mm in -0.05_f32..0.05,
        places in prop::collection::vec((-1.0_f32..=1.0, -1.0_f32..=1.0), 8),
    ) {
        let mut record = cameras::square(lens, axis);
        record.fitted = Some(cameras::fitted(&lens));
        let calibration = Calibration::new(record).unwrap();
        let corrections = [
            FrameCorrection::without_motion(&calibration),
            FrameCorrection::exact(&calibration, &motion, &cameras::focus(&calibration, shift_mm)),
            FrameCorrection::five_coefficient(&calibration, &motion).unwrap(),
        ];
        let half = calibration.sensor().half_width_mm();
        for correction in &corrections {
            for (x, y) in &places {
                let point = SensorPoint::new(x * half, y * half);
                prop_assert!(comes_back(correction, point), "{point:?}");
            }
        }
    }

    #[test]
    fn any_ideal_point_gives_a_point_that_corrects_to_it_or_an_error(
        lens in cameras::lenses(),
        x in prop::num::f32::ANY,
        y in prop::num::f32::ANY,
    ) {
        let calibration = Calibration::new(cameras::square(lens, FmcAxis::default())).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let ideal = SensorPoint::new(x, y);
        if let Ok(measured) = correction.distort(ideal) {
            prop_assert!(calibration.sensor().contains(measured.point));
            let back = correction.correct(measured.point).point;
            // 42 mm off the centre a unit in the last place is 3.8 nm.
            prop_assert!((back.x_mm - x).abs() <= 8e-6 && (back.y_mm - y).abs() <= 8e-6);
        }
    }
}

#[test]
fn published_cameras_come_back_within_two_ulps_edges_included() {
    for record in cameras::published() {
        let calibration = Calibration::new(record).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        for point in cameras::grid(&calibration, 101) {
            assert!(comes_back(&correction, point), "{point:?}");
        }
    }
}

#[test]
fn strongest_lens_that_is_accepted_comes_back_too() {
    let mut strongest = None;
    for step in 1..=60_u8 {
        let lens = fmc_camera::geometry::brown::Brown {
            k1: 1e-5 * f32::from(step),
            ..Default::default()
        };
        if let Ok(calibration) = Calibration::new(cameras::square(lens, FmcAxis::default())) {
            strongest = Some(calibration);
        }
    }
    let calibration = strongest.unwrap();
    assert!(calibration.least_scale() < 0.3, "no strong lens was tried");
    let correction = FrameCorrection::without_motion(&calibration);
    for point in cameras::grid(&calibration, 41) {
        let ideal = correction.correct(point).point;
        let back = correction.distort(ideal).unwrap().point;
        // The scale of the image falls to 0.2, and the rounding of the ideal point grows
        // accordingly.
        assert!((back.x_mm - point.x_mm).abs() < 4e-5 && (back.y_mm - point.y_mm).abs() < 4e-5);
    }
}

#[test]
fn ideal_point_of_no_sensor_point_is_an_error() {
    let record = cameras::published()[0];
    let calibration = Calibration::new(record).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    assert!(matches!(
        correction.distort(SensorPoint::new(30.0, 0.0)),
        Err(DistortError::OffSensor(_))
    ));
    for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
        assert!(correction.distort(SensorPoint::new(bad, 0.0)).is_err());
    }
}
