//! Zeros of both signs, subnormal numbers, infinities and NaNs.

use fmc_camera_kernel::Coefficients;

use crate::call::{FORM, TERMS, assert_all_same, batches, portable};

const CORNERS: [f32; 17] = [
    0.0,
    -0.0,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    3e-39,
    -3e-39,
    f32::EPSILON,
    40.32,
    -40.32,
    1e19,
    -1e19,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

fn assert_corners_are_the_same(form: Coefficients) {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for a in CORNERS {
        for b in CORNERS {
            x.push(a);
            y.push(b);
        }
    }
    for terms in TERMS {
        let (ideal_x, ideal_y) = portable(&form, terms, &x, &y);
        for (name, batch) in batches(form, terms) {
            assert_all_same(&name, &batch, (&x, &y), (&ideal_x, &ideal_y));
        }
    }
}

#[test]
fn corners_have_the_bits_of_the_portable_kernel() {
    assert_corners_are_the_same(FORM);
}

#[test]
fn a_frame_without_distortion_leaves_the_bits_of_a_point_on_the_sensor() {
    let still = Coefficients::default();
    assert_corners_are_the_same(still);
    let (mut x, mut y): (Vec<f32>, Vec<f32>) = (
        vec![-0.0, 0.0, 1e-45, 40.32],
        vec![0.0, -1e-45, -0.0, -40.32],
    );
    let before: Vec<u32> = x.iter().chain(&y).map(|number| number.to_bits()).collect();
    for (name, batch) in batches(still, TERMS[0]) {
        batch.xy(&mut x, &mut y);
        let after: Vec<u32> = x.iter().chain(&y).map(|number| number.to_bits()).collect();
        assert_eq!(after, before, "{name}");
    }
}

#[test]
fn coefficients_that_overflow_have_the_bits_of_the_portable_kernel() {
    assert_corners_are_the_same(Coefficients {
        k3: 1e30,
        k1: -1e30,
        ..FORM
    });
    assert_corners_are_the_same(Coefficients {
        k0: 1e-40,
        hx: 1e-42,
        ..Coefficients::default()
    });
}
