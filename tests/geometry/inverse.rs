//! `distort` against double precision, slices of points, and refusals.

use crate::geometry::cameras;
use crate::geometry::jacobian::brown;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::frame_correction::{FrameCorrection, Terms};
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use proptest::prelude::*;

/// Largest error of a displacement of a published camera, nm: that of the distortion (`accuracy`).
const MAX_NM: f64 = 0.11;
/// Root mean square, nm.
const RMS_NM: f64 = 0.02;
/// Mean, nm.
const BIAS_NM: f64 = 0.001;

/// Returns the displacement of an ideal point, counted from the principal point, by iteration in
/// double precision.
fn displaced(lens: &Brown, [x, y]: [f64; 2]) -> [f64; 2] {
    let mut d = [0.0, 0.0];
    for _ in 0..60 {
        d = brown(lens, x + d[0], y + d[1]);
    }
    d
}

#[test]
fn displacement_of_an_ideal_point_is_that_of_double_precision() {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    let mut largest = 0.0_f64;
    for record in cameras::published() {
        let calibration = Calibration::new(record).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let pp = [record.principal_point.x_mm, record.principal_point.y_mm].map(f64::from);
        for point in cameras::grid(&calibration, 101) {
            let ideal = correction.correct(point).point;
            // At the edge rounding decides whether the measured point is on the sensor.
            let Ok(found) = correction.distort(ideal) else {
                panic!("{ideal:?}")
            };
            let [x, y] = [ideal.x_mm, ideal.y_mm].map(f64::from);
            let expected = displaced(&record.distortion, [x - pp[0], y - pp[1]]);
            let found = [found.distortion.dx_mm, found.distortion.dy_mm].map(f64::from);
            for axis in 0..2 {
                let error_nm = 1e6 * (found[axis] - expected[axis]);
                largest = largest.max(error_nm.abs());
                sum += error_nm;
                squares += error_nm * error_nm;
                count += 1.0;
            }
        }
    }
    let (rms, bias): (f64, f64) = ((squares / count).sqrt(), sum / count);
    println!("largest {largest} nm, rms {rms} nm, bias {bias} nm");
    assert!(largest <= MAX_NM, "{largest} nm");
    assert!(rms <= RMS_NM, "rms {rms} nm");
    assert!(bias.abs() <= BIAS_NM, "bias {bias} nm");
}

/// Returns a correction of 20 % of distortion at the corner of 80 mm x 60 mm, close to folding.
fn strong() -> FrameCorrection {
    let mut record = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    record.distortion.k1 = 9e-5;
    FrameCorrection::without_motion(&Calibration::new(record).unwrap())
}

/// Returns a short and a full correction of a published lens, and a strong one.
fn corrections() -> [FrameCorrection; 3] {
    let mut record = cameras::published()[0];
    let short = FrameCorrection::without_motion(&Calibration::new(record).unwrap());
    record.distortion.b1 = 1e-4;
    record.distortion.b2 = -2e-4;
    let full = FrameCorrection::without_motion(&Calibration::new(record).unwrap());
    assert_eq!([short.terms(), full.terms()], [Terms::Short, Terms::Full]);
    [short, full, strong()]
}

/// Compares a slice with single points: the bits are the same up to the first point that is
/// refused, which the error names.
fn assert_same_bits(correction: &FrameCorrection, ideal: &[SensorPoint]) {
    let mut points = ideal.to_vec();
    let answer = correction.distort_slice(&mut points);
    let singles: Vec<_> = ideal.iter().map(|p| correction.distort(*p)).collect();
    let replaced = singles.iter().take_while(|single| single.is_ok()).count();
    for (point, single) in points.iter().zip(&singles).take(replaced) {
        let single = single.unwrap().point;
        assert_eq!(point.x_mm.to_bits(), single.x_mm.to_bits());
        assert_eq!(point.y_mm.to_bits(), single.y_mm.to_bits());
    }
    for (point, left) in points.iter().zip(ideal).skip(replaced) {
        assert_eq!(point.x_mm.to_bits(), left.x_mm.to_bits());
        assert_eq!(point.y_mm.to_bits(), left.y_mm.to_bits());
    }
    // The errors are compared as text, because one of them has a NaN.
    let refused = answer.err().map(|refused| (refused.index, refused.error));
    let expected = singles.get(replaced).map(|s| (replaced, s.unwrap_err()));
    assert_eq!(format!("{refused:?}"), format!("{expected:?}"));
}

proptest! {
    #[test]
    fn slices_have_the_bits_of_single_points(
        lens in cameras::lenses(),
        motion in cameras::motions(),
        // Up to three blocks of those that are gone through side by side.
        points in prop::collection::vec((-24.0_f32..24.0, -18.0_f32..18.0), 0..250),
        far in prop::option::of((0_usize..250, 20.0_f32..60.0)),
    ) {
        let mut points: Vec<_> = points.into_iter().map(|(x, y)| SensorPoint::new(x, y)).collect();
        if let Some((index, x_mm)) = far && let Some(point) = points.get_mut(index) {
            point.x_mm = x_mm;
        }
        let calibration = Calibration::new(cameras::square(lens, FmcAxis::PlusY)).unwrap();
        let focus = cameras::focus(&calibration, 0.005);
        assert_same_bits(&FrameCorrection::exact(&calibration, &motion, &focus), &points);
        for correction in corrections() {
            assert_same_bits(&correction, &points);
        }
    }
}

#[test]
fn first_point_that_is_refused_is_named_wherever_it_stands() {
    let good = SensorPoint::new(12.5, -7.25);
    let bad = [
        SensorPoint::new(60.0, 0.0),
        SensorPoint::new(0.0, -60.0),
        SensorPoint::new(f32::NAN, 1.0),
        SensorPoint::new(1.0, f32::INFINITY),
        SensorPoint::new(f32::MAX, f32::MIN),
    ];
    for correction in corrections() {
        for bad in bad {
            for place in 0..5 {
                let mut points = vec![good; 5];
                points[place] = bad;
                assert_same_bits(&correction, &points);
                let refused = correction.distort_slice(&mut points).unwrap_err();
                assert_eq!(refused.index, place);
            }
        }
        assert_same_bits(&correction, &[]);
        assert_eq!(correction.distort_slice(&mut [good; 3]), Ok(()));
    }
    // In and behind blocks, among points that the first step ends and others that it does not.
    for correction in corrections() {
        for length in [63, 64, 65, 200] {
            let mut points: Vec<_> = (0..length)
                .map(|index: u16| SensorPoint::new(0.1 * f32::from(index), -4.0))
                .collect();
            assert_same_bits(&correction, &points);
            let last = points.len() - 1;
            for place in [0, 31, 62, last] {
                for bad in bad {
                    points[place] = bad;
                    assert_same_bits(&correction, &points);
                    points[place] = good;
                }
            }
        }
    }
    let [short, ..] = corrections();
    let mut points = [good, SensorPoint::new(30.0, 0.0)];
    let refused = short.distort_slice(&mut points).unwrap_err();
    assert!(matches!(refused.error, DistortError::OffSensor(at) if at.x_mm > 26.7));
}

#[test]
fn strong_lens_gives_the_point_back_or_an_error_and_no_other_point() {
    let correction = strong();
    let mut found = 0_u16;
    for row in -30_i8..=30 {
        for column in -40_i8..=40 {
            let measured = SensorPoint::new(f32::from(column), f32::from(row));
            let ideal = correction.correct(measured).point;
            if let Ok(back) = correction.distort(ideal) {
                found += 1;
                // The scale of the image falls to 0.3: two units of 3.8 nm of the ideal point are
                // stretched by it.
                let off = |a: f32, b: f32| (a - b).abs();
                assert!(
                    off(back.point.x_mm, measured.x_mm) <= 2.6e-5,
                    "{measured:?}"
                );
                assert!(
                    off(back.point.y_mm, measured.y_mm) <= 2.6e-5,
                    "{measured:?}"
                );
            }
        }
    }
    assert_eq!(found, 81 * 61, "every one was found before");
}
