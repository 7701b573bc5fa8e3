//! Ten million random points.

use fmc_camera_kernel::Coefficients;

use crate::call::{TERMS, assert_all_same, batches, portable};

/// Number of frames, each with different points.
const FRAMES: u64 = 10;
/// Number of points of a frame.
const POINTS: usize = 1_000_000;

#[test]
fn ten_million_random_points_have_the_bits_of_the_portable_kernel() {
    for seed in 0..FRAMES {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut about = |size: f32| size * (2.0 * random.f32() - 1.0);
        let form = Coefficients {
            cx: about(0.1),
            cy: about(0.1),
            k0: about(1e-3),
            k1: about(1e-6),
            k2: about(1e-10),
            k3: about(1e-14),
            hx: about(1e-6),
            hy: about(1e-6),
            gx: about(1e-6),
            gy: about(1e-6),
            b1: about(1e-4),
            b2: about(1e-4),
            tx: about(1e-5),
            ty: about(1e-5),
        };
        // Half of the largest format of a film camera.
        let x: Vec<f32> = (0..POINTS).map(|_| about(115.0)).collect();
        let y: Vec<f32> = (0..POINTS).map(|_| about(230.0)).collect();
        for terms in TERMS {
            let (ideal_x, ideal_y) = portable(&form, terms, &x, &y);
            assert!(ideal_x != x && ideal_y != y, "something is corrected");
            for (name, batch) in batches(form, terms) {
                assert_all_same(&name, &batch, (&x, &y), (&ideal_x, &ideal_y));
            }
        }
    }
}

#[test]
fn any_bits_are_numbers_that_give_the_bits_of_the_portable_kernel() {
    let mut random = fastrand::Rng::with_seed(77);
    let mut any = || f32::from_bits(random.u32(..));
    let x: Vec<f32> = (0..200_000).map(|_| any()).collect();
    let y: Vec<f32> = (0..200_000).map(|_| any()).collect();
    for terms in TERMS {
        let (ideal_x, ideal_y) = portable(&crate::call::FORM, terms, &x, &y);
        for (name, batch) in batches(crate::call::FORM, terms) {
            assert_all_same(&name, &batch, (&x, &y), (&ideal_x, &ideal_y));
        }
    }
}
