//! 2-D direct linear transformation: table and lens, gauge of the table, noise.

use fmc_adjustment::calibration::dlt2d::distortion_table::Dlt2d;
use fmc_adjustment::calibration::dlt2d::dlt2d;
use fmc_adjustment::calibration::dlt2d::request::{Dlt2dRequest, PlaneTarget};
use fmc_adjustment::calibration::dlt3d::pinhole::Pinhole;
use nalgebra::{DMatrix, DVector, Vector3};

use crate::noise::binomial_half_width;
use crate::plane::{F, HALF, K1, corners, nominal, request, tabulated, targets, tilted, untilted};

/// Returns the largest distance between two sets of points after the homography that carries the
/// first into the second best, mm.
#[expect(clippy::many_single_char_names, reason = "symbols of a homography")]
fn after_one_homography(from: &[[f64; 2]], to: &[[f64; 2]]) -> f64 {
    let mut eight = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let image = |eight: &[f64; 8], [x, y]: [f64; 2]| {
        let [a, b, c, d, e, f, g, h] = *eight;
        let scale = g * x + h * y + 1.0;
        (
            [(a * x + b * y + c) / scale, (d * x + e * y + f) / scale],
            scale,
        )
    };
    let mut largest = 0.0;
    for _ in 0..6 {
        let (mut rows, mut right) = (Vec::new(), Vec::new());
        largest = 0.0_f64;
        for ([x, y], [u, v]) in from.iter().zip(to) {
            let ([p, q], s) = image(&eight, [*x, *y]);
            let [a, b, one] = [x / s, y / s, 1.0 / s];
            rows.extend([a, b, one, 0.0, 0.0, 0.0, -p * a, -p * b]);
            rows.extend([0.0, 0.0, 0.0, a, b, one, -q * a, -q * b]);
            right.extend([u - p, v - q]);
            largest = largest.max((u - p).hypot(v - q));
        }
        let design = DMatrix::from_row_slice(right.len(), 8, &rows);
        let step = design
            .svd(true, true)
            .solve(&DVector::from_vec(right), 0.0)
            .unwrap();
        for (element, change) in eight.iter_mut().zip(step.iter()) {
            *element += change;
        }
    }
    largest
}

fn ideal_of_table(found: &Dlt2d) -> Vec<[f64; 2]> {
    let rows = found.rows.iter();
    rows.map(|row| {
        let [x, y] = row.measured_mm;
        let [dx, dy] = row.distortion_mm;
        [x - dx, y - dy]
    })
    .collect()
}

fn ideal_of_lens(camera: &Pinhole, targets: &[PlaneTarget]) -> Vec<[f64; 2]> {
    let [x0, y0] = camera.principal_point_mm;
    targets
        .iter()
        .map(|target| {
            let [x, y] = target.plane_m;
            let direction = camera.in_camera(&Vector3::new(x, y, 0.0));
            let scale = -camera.principal_distance_mm / direction.z;
            [x0 + scale * direction.x, y0 + scale * direction.y]
        })
        .collect()
}

#[test]
fn table_is_the_lens_after_one_homography() {
    let camera = tilted();
    let targets = targets(&camera, 0.0, 1);
    let lens = ideal_of_lens(&camera, &targets);
    let names = corners();
    for corners in [None, Some(&names)] {
        let found = tabulated(&targets, &nominal(&camera), corners).unwrap();
        let table = ideal_of_table(&found);
        // 1e-6 nm.
        let difference_mm = after_one_homography(&table, &lens);
        assert!(difference_mm < 1e-12, "{difference_mm:.1e} mm");
        // Taken literally, with f and principal point of the lens, it is wrong by tens of µm.
        let literally = table
            .iter()
            .zip(&lens)
            .map(|([x, y], [u, v])| (x - u).hypot(y - v))
            .fold(0.0, f64::max);
        assert!(literally > 0.01, "{literally}");
    }
}

#[test]
fn polynomial_of_the_camera_file_is_that_of_the_lens() {
    let camera = tilted();
    let found = tabulated(&targets(&camera, 0.0, 1), &nominal(&camera), None).unwrap();
    let truth = [K1, 0.0, 0.0, 2e-5, -1e-5];
    let tolerance = [1e-12, 1e-13, 1e-14, 1e-12, 1e-12];
    for ((name, truth), tolerance) in ["k1", "k2", "k3", "p1", "p2"]
        .into_iter()
        .zip(truth)
        .zip(tolerance)
    {
        let value = found.result.parameter(name).unwrap().value;
        assert!((value - truth).abs() < tolerance, "{name} {value} {truth}");
    }
    let (_, largest) = found.result.residual_size_mm().unwrap();
    assert!(largest < 1e-12, "{largest:.1e} mm");
}

#[test]
fn corner_table_of_a_radial_lens_has_the_gauge_of_its_corners() {
    let camera = untilted();
    let targets = targets(&camera, 0.0, 1);
    let names = corners();
    let found = tabulated(&targets, &nominal(&camera), Some(&names)).unwrap();
    let [x, y] = targets[0].measured_mm;
    let square = x * x + y * y;
    let gauge = found.gauge;
    assert!((gauge.principal_distance_mm - F / (1.0 - K1 * square)).abs() < 1e-11);
    assert!(gauge.principal_point_mm.iter().all(|mm| mm.abs() < 1e-9));
    assert!(gauge.affinity.iter().all(|one| one.abs() < 1e-11));
    assert!(gauge.axis_deg < 1e-6, "{}", gauge.axis_deg);
    for row in &found.rows {
        let [x, y] = row.measured_mm;
        let factor = K1 * (x * x + y * y - square) / (1.0 - K1 * square);
        let [dx, dy] = row.distortion_mm;
        assert!((dx - factor * x).hypot(dy - factor * y) < 1e-12);
    }
    // The corners of the format are those of the table.
    assert!(x.abs() < HALF[0] && y.abs() < HALF[1]);
}

#[test]
fn tilted_corner_table_has_an_interior_orientation_of_its_own() {
    let camera = tilted();
    let names = corners();
    let found = tabulated(&targets(&camera, 0.0, 1), &nominal(&camera), Some(&names)).unwrap();
    let gauge = found.gauge;
    // The decentring that the corners have goes into the axis and the principal point.
    assert!(gauge.axis_deg > 1e-4, "{}", gauge.axis_deg);
    let moved = gauge.principal_point_mm[0] - 0.03;
    assert!(moved.abs() > 1e-4, "{moved}");
    // Seen with that interior orientation the table's rays have the angles of the lens's rays.
    let rays = |points: &[[f64; 2]], f: f64, [x0, y0]: [f64; 2], [b1, b2]: [f64; 2]| {
        points
            .iter()
            .map(|[x, y]| {
                let [x, y] = [x - x0, y - y0];
                Vector3::new(x * (1.0 - b1) - b2 * y, y, -f).normalize()
            })
            .collect::<Vec<_>>()
    };
    let targets = targets(&camera, 0.0, 1);
    let lens = rays(
        &ideal_of_lens(&camera, &targets),
        F,
        camera.principal_point_mm,
        [0.0; 2],
    );
    let table = rays(
        &ideal_of_table(&found),
        gauge.principal_distance_mm,
        gauge.principal_point_mm,
        gauge.affinity,
    );
    for (a, b) in (0..149).map(|index| (index, index + 1)) {
        let angle = |rays: &[Vector3<f64>]| rays[a].cross(&rays[b]).norm();
        assert!((angle(&lens) - angle(&table)).abs() < 1e-12);
    }
}

#[test]
fn corners_pass_their_noise_on_to_the_table() {
    let camera = tilted();
    let nominal = nominal(&camera);
    let names = corners();
    let mut squares = [0.0; 2];
    let seeds = 60_u32;
    for (sum, corners) in squares.iter_mut().zip([Some(&names), None]) {
        let exact = tabulated(&targets(&camera, 0.0, 1), &nominal, corners).unwrap();
        for seed in 0..seeds {
            // 0.02 px.
            let targets = targets(&camera, 0.125, u64::from(seed));
            let noisy = dlt2d(&Dlt2dRequest {
                keeps_all: true,
                ..request(&targets, &nominal, corners)
            })
            .unwrap();
            for (a, b) in noisy.rows.iter().zip(&exact.rows) {
                for (a, b) in a.distortion_mm.into_iter().zip(b.distortion_mm) {
                    *sum += (1e6 * (a - b)).powi(2) / (300.0 * f64::from(seeds));
                }
            }
        }
    }
    let [with_corners, with_all] = squares.map(f64::sqrt);
    assert!((with_all - 123.0).abs() < 2.0, "{with_all} nm");
    assert!((with_corners - 159.0).abs() < 8.0, "{with_corners} nm");
}

#[test]
fn sigma_covers_the_error_of_the_polynomial() {
    let camera = tilted();
    let nominal = nominal(&camera);
    let truth = [K1, 0.0, 0.0, 2e-5, -1e-5];
    let seeds = 400_u32;
    let mut hits = [0.0; 5];
    for seed in 0..seeds {
        let found = tabulated(&targets(&camera, 0.5, u64::from(seed)), &nominal, None).unwrap();
        for ((hits, name), truth) in hits
            .iter_mut()
            .zip(["k1", "k2", "k3", "p1", "p2"])
            .zip(truth)
        {
            let error = found.result.parameter(name).unwrap().value - truth;
            if error.abs() <= found.result.sigma(name).unwrap() {
                *hits += 1.0;
            }
        }
    }
    for hits in hits {
        let share = hits / f64::from(seeds);
        assert!(
            (share - 0.6827).abs() < binomial_half_width(f64::from(seeds)),
            "{share}"
        );
    }
}
