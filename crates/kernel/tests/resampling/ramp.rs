//! Geometry of the kernels: by how much they move a linear ramp.

use fmc_camera_kernel::resampling::{Kernel, PLACE_BITS, Resampler, Run, weights};

use crate::image::Image;

/// Largest way by which a kernel moves a linear ramp, px.
const MOVED: [(Kernel, f64, f64); 4] = [
    (Kernel::Bilinear, 0.0, 1e-12),
    (Kernel::Bicubic, 0.0, 1e-12),
    (Kernel::Keys6, 0.0, 1e-12),
    (Kernel::Lanczos3, 0.0195, 0.0205),
];

#[test]
fn weights_move_a_ramp_as_their_kernel_does_and_have_the_sum_one() {
    for (kernel, least, most) in MOVED {
        let mut moved = 0.0_f64;
        for step in 0..=1000 {
            let t = f64::from(step) / 1000.0;
            let weights = weights(kernel, t);
            let sum: f64 = weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-14, "{kernel}: {sum}");
            let before = f64::from(kernel.half_taps()) - 1.0;
            let mut place = -before;
            let mut moment = 0.0;
            for weight in weights {
                moment += weight * place;
                place += 1.0;
            }
            moved = moved.max((moment - t).abs());
        }
        assert!((least..=most).contains(&moved), "{kernel}: {moved}");
    }
}

#[test]
fn a_ramp_comes_back_at_every_fraction_to_the_rounding_of_a_count() {
    // 500 counts per pixel: half a count is 0.001 px, half a fraction of 1/2048 px an eighth of
    // one.
    for transposed in [false, true] {
        let mut number = 0;
        let image = Image::<u16>::new([96, 96], 1, || {
            let (col, row) = (number % 96, number / 96);
            number += 1;
            (if transposed { row } else { col }) * 500 + 3000
        });
        for kernel in [Kernel::Bilinear, Kernel::Bicubic, Kernel::Keys6] {
            let resampler = Resampler::new(kernel);
            for fraction in 0..3000 {
                let across = fraction * 5592;
                let run = Run {
                    base_px: [20, 40],
                    start: if transposed {
                        [777, across]
                    } else {
                        [across, 777]
                    },
                    step: [1 << PLACE_BITS, 0],
                    count: 16,
                    border: false,
                };
                let (out, ..) = image.row(&resampler, &[run]);
                for (t, found) in (0..).zip(out) {
                    let t = f64::from(t);
                    let share = f64::from(across) / f64::from(1 << PLACE_BITS);
                    let place = if transposed {
                        40.0 + share
                    } else {
                        20.0 + share + t
                    };
                    let error = f64::from(found) - (place * 500.0 + 3000.0);
                    assert!(
                        error.abs() <= 0.5 + 500.0 / 4096.0 + 0.02,
                        "{kernel}: {error}"
                    );
                }
            }
        }
    }
}
