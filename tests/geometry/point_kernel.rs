//! Bits of slices of points, which are those of single points.

use crate::geometry::cameras;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::{FrameCorrection, Terms};
use fmc_camera::geometry::point_kernel::LengthsDiffer;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use proptest::prelude::*;

/// A point beside the slice, which must stay.
const GUARD: SensorPoint = SensorPoint::new(-7.25, 7.5);

/// Returns the bits of the coordinates; all NaN are equal.
fn bits(point: SensorPoint) -> [u32; 2] {
    [point.x_mm, point.y_mm].map(|value| {
        if value.is_nan() {
            f32::NAN.to_bits()
        } else {
            value.to_bits()
        }
    })
}

/// Compares slices of both layouts with `correct`, point by point.
fn assert_same_bits(correction: &FrameCorrection, measured: &[SensorPoint]) {
    let expected: Vec<_> = [GUARD]
        .into_iter()
        .chain(measured.iter().map(|p| correction.correct(*p).point))
        .chain([GUARD])
        .map(bits)
        .collect();
    let guarded: Vec<_> = [&[GUARD], measured, &[GUARD]].concat();
    let inside = 1..=measured.len();

    let mut pairs = guarded.clone();
    correction.correct_slice(&mut pairs[inside.clone()]);
    assert_eq!(pairs.into_iter().map(bits).collect::<Vec<_>>(), expected);

    let mut x: Vec<_> = guarded.iter().map(|p| p.x_mm).collect();
    let mut y: Vec<_> = guarded.iter().map(|p| p.y_mm).collect();
    correction
        .correct_slice_xy(&mut x[inside.clone()], &mut y[inside])
        .unwrap();
    let apart = x.into_iter().zip(y).map(|(x, y)| SensorPoint::new(x, y));
    assert_eq!(apart.map(bits).collect::<Vec<_>>(), expected);
}

/// Returns a short and a full correction of a published lens.
fn short_and_full() -> [FrameCorrection; 2] {
    let published = cameras::published();
    let short = FrameCorrection::without_motion(&Calibration::new(published[0]).unwrap());
    let mut record = published[0];
    record.distortion.b1 = 1e-4;
    record.distortion.b2 = -2e-4;
    let full = FrameCorrection::without_motion(&Calibration::new(record).unwrap());
    assert_eq!([short.terms(), full.terms()], [Terms::Short, Terms::Full]);
    [short, full]
}

proptest! {
    #[test]
    fn slices_have_the_bits_of_single_points(
        lens in cameras::lenses(),
        motion in cameras::motions(),
        points in prop::collection::vec((-60.0_f32..60.0, -60.0_f32..60.0), 0..50),
    ) {
        let points: Vec<_> = points.into_iter().map(|(x, y)| SensorPoint::new(x, y)).collect();
        let with_all_terms = cameras::square(lens, FmcAxis::PlusY);
        let calibration = Calibration::new(with_all_terms);
        prop_assume!(calibration.is_ok());
        let calibration = calibration.unwrap();
        let focus = cameras::focus(&calibration, 0.005);
        assert_same_bits(&FrameCorrection::exact(&calibration, &motion, &focus), &points);
        for correction in short_and_full() {
            assert_same_bits(&correction, &points);
        }
    }
}

#[test]
fn every_length_and_every_special_number_has_the_bits_of_single_points() {
    let special = [
        0.0,
        -0.0,
        1e-45,
        -f32::MIN_POSITIVE,
        35.0,
        -35.0,
        f32::MAX,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    let points: Vec<_> = special
        .iter()
        .flat_map(|x| special.iter().map(|y| SensorPoint::new(*x, *y)))
        .collect();
    for correction in short_and_full() {
        for length in 0..points.len() {
            assert_same_bits(&correction, &points[..length]);
            assert_same_bits(&correction, &points[points.len() - length..]);
        }
    }
}

#[test]
fn x_and_y_of_different_numbers_are_refused_and_left_alone() {
    let [short, _] = short_and_full();
    let (mut x, mut y) = ([20.0; 7], [-10.0; 6]);
    let refused = short.correct_slice_xy(&mut x, &mut y);
    assert_eq!(refused, Err(LengthsDiffer { x: 7, y: 6 }));
    assert_eq!((x, y), ([20.0; 7], [-10.0; 6]));
}
