//! The four interpolations of a table, against the lens.

use fmc_adjustment::calibration::dlt2d::interpolation::{
    InterpolatedTable, Interpolator, main_term,
};

use crate::noise::Noise;
use crate::plane::{K1, nominal, tabulated, targets, tilted};

/// Distance of the targets, mm.
const PITCH: f64 = 0.9;

/// 1 % lens about the middle.
fn distortion([x, y]: [f64; 2]) -> [f64; 2] {
    let factor = K1 * (x * x + y * y);
    [x * factor, y * factor]
}

/// 15 x 10 targets in the middles of 15 x 10 parts of the format, at their measured places.
fn table(noise_mm: f64) -> (InterpolatedTable, Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let mut noise = Noise::new(5);
    let points: Vec<[f64; 2]> = (0..150_u32)
        .map(|index| {
            let [column, row] = [index % 15, index / 15].map(f64::from);
            [PITCH * (column - 7.0), PITCH * (row - 4.5)]
        })
        .collect();
    let values: Vec<[f64; 2]> = points
        .iter()
        .map(|point| distortion(*point).map(|mm| mm + noise_mm * noise.gaussian()))
        .collect();
    let table = InterpolatedTable::new(points.clone(), values.clone(), &points);
    (table, points, values)
}

/// Largest and rms error over the format, µm.
fn errors(interpolated: impl Fn([f64; 2]) -> Option<[f64; 2]>) -> [f64; 2] {
    let (mut largest, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
    for row in 0..91 {
        for column in 0..136 {
            let place = |index: i32, count: f64, half: f64| {
                0.999_999 * half * (f64::from(index) / count * 2.0 - 1.0)
            };
            let point = [
                place(column, 135.0, 7.0 * PITCH),
                place(row, 90.0, 4.5 * PITCH),
            ];
            let found = interpolated(point).expect("inside of the targets");
            for (found, truth) in found.into_iter().zip(distortion(point)) {
                let error = 1e3 * (found - truth);
                largest = largest.max(error.abs());
                squares += error * error;
                count += 1.0;
            }
        }
    }
    [largest, f64::sqrt(squares / count)]
}

#[test]
fn errors_of_the_four_interpolations_are_those_of_their_order() {
    let (table, points, values) = table(0.0);
    let (k, remainder) = main_term(&points, &values, [0.0; 2]).unwrap();
    let without = table.with_values(remainder);
    let with_main_term = |interpolator: Interpolator, [x, y]: [f64; 2]| {
        let [u, v] = without.at(interpolator, [x, y])?;
        let square = x * x + y * y;
        let [k0, k1, k2] = k;
        let factor = k0 + square * (k1 + square * k2);
        Some([u + x * factor, v + y * factor])
    };
    // Largest and rms error, µm: bilinear, moving quadric, triangles, mean.
    let reference = [[0.77, 0.29], [0.057, 0.027], [0.98, 0.35], [8.0, 1.4]];
    for (interpolator, [largest, rms]) in Interpolator::ALL.into_iter().zip(reference) {
        let [found_largest, found_rms] = errors(|point| table.at(interpolator, point));
        assert!((found_rms / rms - 1.0).abs() < 0.3, "{found_rms} {rms}");
        // The largest errors of quadric and mean stand at the border of the targets: they depend
        // on the weights and on how far out the points lie.
        let tolerance = match interpolator {
            Interpolator::MovingQuadric => 0.6,
            Interpolator::NearestMean => 0.4,
            Interpolator::Bilinear | Interpolator::Triangles => 0.15,
        };
        assert!(
            (found_largest / largest - 1.0).abs() < tolerance,
            "{}: {found_largest} {largest}",
            interpolator.name()
        );
        // The lens is its main term, so that nothing is left to interpolate.
        let [after, _] = errors(|point| with_main_term(interpolator, point));
        assert!(after < 1e-9, "{}: {after}", interpolator.name());
    }
}

#[test]
fn noise_passes_through_the_interpolations_after_the_main_term() {
    // 0.02 px are 0.125 µm: 0.081, 0.102, 0.087, 0.063 µm rms.
    let (table, points, values) = table(0.125e-3);
    let (k, remainder) = main_term(&points, &values, [0.0; 2]).unwrap();
    let without = table.with_values(remainder);
    let reference = [0.081, 0.102, 0.087, 0.063];
    for (interpolator, reference) in Interpolator::ALL.into_iter().zip(reference) {
        let [_, rms] = errors(|[x, y]| {
            let [u, v] = without.at(interpolator, [x, y])?;
            let square = x * x + y * y;
            let factor = k[0] + square * (k[1] + square * k[2]);
            Some([u + x * factor, v + y * factor])
        });
        assert!(
            (rms / reference - 1.0).abs() < 0.15,
            "{}: {rms}",
            interpolator.name()
        );
    }
}

#[test]
fn cross_validation_orders_the_interpolations_as_their_errors_do() {
    let camera = tilted();
    let found = tabulated(&targets(&camera, 0.0, 1), &nominal(&camera), None).unwrap();
    let rms: Vec<f64> = found
        .interpolation()
        .iter()
        .map(|one| one.of_table.unwrap().rms_mm)
        .collect();
    let [bilinear, quadric, triangles, mean] = rms.try_into().unwrap();
    assert!(quadric < 0.5 * bilinear && quadric < 0.5 * triangles);
    assert!(mean > bilinear || mean > triangles);
    for one in found.interpolation() {
        let (table, remainder) = (one.of_table.unwrap(), one.of_remainder.unwrap());
        assert!(remainder.rms_mm < table.rms_mm);
        assert!(table.targets >= 100, "{}", table.targets);
    }
}
