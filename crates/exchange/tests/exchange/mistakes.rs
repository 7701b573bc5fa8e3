//! Mistakes in conventions, made on purpose: each costs micrometres that the comparison sees.

use fmc_exchange::comparison;
use fmc_exchange::pinhole::Pinhole;
use fmc_exchange::program::Program;

use crate::support::{ixm, pinhole, rc30, written};

/// Mistake, and its largest residual on the iXM and on the RC30, µm, as found elsewhere.
type Mistake = (&'static str, fn(&mut Pinhole), [f64; 2]);

const MISTAKES: [Mistake; 4] = [
    (
        "half a pixel",
        |camera| camera.centre_px = camera.centre_px.map(|c| c + 0.5),
        [2.28, 6.35],
    ),
    (
        "p1 and p2 exchanged",
        |camera| camera.decentring.swap(0, 1),
        [23.3, 4.42],
    ),
    (
        "y of p1 not reversed",
        |camera| camera.decentring[0] *= -1.0,
        [17.3, 4.63],
    ),
    (
        "K0 forgotten",
        |camera| camera.focal_px = camera.focal_px.map(|f| f * (1.0 + 0.3285e-4)),
        [0.0, 3.76],
    ),
];

fn largest_um(camera: &fmc_exchange::calibrated::Calibrated, change: impl Fn(&mut Pinhole)) -> f64 {
    let mut formula = pinhole(&written(camera, Program::OpenCv, "opencv5"));
    change(&mut formula);
    comparison::measured(camera, &formula).largest_um
}

#[test]
fn each_mistake_costs_what_it_costs_elsewhere() {
    for (mistake, change, [ixm_um, rc30_um]) in MISTAKES {
        for (camera, expected) in [(ixm(), ixm_um), (rc30(), rc30_um)] {
            let found = largest_um(&camera, change);
            if expected > 0.0 {
                assert!(
                    (found / expected - 1.0).abs() < 0.01,
                    "{mistake}: {found} µm"
                );
            }
        }
    }
}

#[test]
fn principal_point_with_its_y_not_reversed_is_seen() {
    for (camera, expected) in [(ixm(), 48.1), (rc30(), 2.0)] {
        let middle = camera.middle_px()[1];
        let found = largest_um(&camera, |formula| {
            formula.centre_px[1] = 2.0 * middle - formula.centre_px[1];
        });
        assert!((found / expected - 1.0).abs() < 0.01, "{found} µm");
    }
}

#[test]
fn copied_coefficients_and_a_reversed_direction_are_seen() {
    for (camera, copied_um, reversed_um) in [(ixm(), 9.64, 674.0), (rc30(), 0.0006, 13.6)] {
        let plain = camera.without_k0();
        let f = plain.principal_distance_mm;
        let copied = |sign: f64| {
            largest_um(&camera, |formula| {
                let [_, k1, k2, k3] = plain.lens.k;
                let [p1, p2] = plain.lens.p;
                formula.radial =
                    [k1 * f * f, k2 * f.powi(4), k3 * f.powi(6), 0.0].map(|k| sign * k);
                formula.decentring = [-p2 * f, p1 * f].map(|p| sign * p);
            })
        };
        assert!(
            (copied(1.0) / copied_um - 1.0).abs() < 0.02,
            "{} µm",
            copied(1.0)
        );
        assert!(
            (copied(-1.0) / reversed_um - 1.0).abs() < 0.02,
            "{} µm",
            copied(-1.0)
        );
    }
}

#[test]
fn inverse_series_is_worse_than_copying() {
    for (camera, expected_um) in [(ixm(), 16.5), (rc30(), 0.0075)] {
        let plain = camera.without_k0();
        let f = plain.principal_distance_mm;
        let [_, k1, k2, k3] = plain.lens.k;
        let [p1, p2] = plain.lens.p;
        let found = largest_um(&camera, |formula| {
            // The inverse of r - k1 r³ - k2 r⁵ - k3 r⁷, in rays.
            let (a, b, c) = (-k1 * f * f, -k2 * f.powi(4), -k3 * f.powi(6));
            let fourth = -12.0 * a * a * a + 8.0 * a * b - c;
            formula.radial = [-a, 3.0 * a * a - b, fourth, 0.0];
            formula.decentring = [-p2 * f, p1 * f];
        });
        assert!((found / expected_um - 1.0).abs() < 0.01, "{found} µm");
    }
}
