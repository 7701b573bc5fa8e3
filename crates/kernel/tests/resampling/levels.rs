//! Bits of every instruction set.

use fastrand::Rng;
use fmc_camera_kernel::host::Level;
use fmc_camera_kernel::resampling::{BANDS, Kernel, Resampler, Sample};

use crate::image::{Image, runs};

/// Compares all levels with the baseline over random rows of images of random samples.
fn compare<S: Sample + PartialEq>(mut sample: impl FnMut(&mut Rng) -> S) {
    let mut rng = Rng::with_seed(3);
    let baseline = Kernel::ALL.map(|kernel| Resampler::new(kernel).at(Level::BASELINE));
    for round in 0..250 {
        for bands in BANDS {
            let size_px = match round % 5 {
                0 => [1 + rng.u32(0..12), 1 + rng.u32(0..12)],
                _ => [60 + rng.u32(0..200), 10 + rng.u32(0..20)],
            };
            let image = Image::new(size_px, bands, || sample(&mut rng));
            let [width, height] = size_px.map(f64::from);
            let stretch = [0.05, 0.5, 2.9][rng.usize(0..3)];
            let step = [
                1.0 + stretch * (rng.f64() - 0.5),
                0.2 * stretch * (rng.f64() - 0.5),
            ];
            let start = [rng.f64() * 20.0 - 10.0, rng.f64() * (height + 4.0) - 2.0];
            let count = (width * 1.2) as u32 + 1;
            let mut row = runs(&mut rng, start, step, count);
            let last = row.len() - 1;
            row[rng.usize(0..=last)].border = rng.u32(0..4) == 0;
            for (baseline, kernel) in baseline.iter().zip(Kernel::ALL) {
                let expected = image.row(baseline, &row);
                for level in Level::all() {
                    let found = image.row(&baseline.clone().at(level), &row);
                    let name = format!("{level}, {kernel}, {bands} bands, {size_px:?}, {row:?}");
                    assert!(found == expected, "{name}");
                }
            }
        }
    }
}

#[test]
fn all_levels_have_the_same_bytes_in_16_bits() {
    compare(|rng| [rng.u16(..), 0, u16::MAX][rng.usize(0..3)]);
}

#[test]
fn all_levels_have_the_same_bytes_in_8_bits() {
    compare(|rng| [rng.u8(..), 0, u8::MAX][rng.usize(0..3)]);
}

/// A comparison on a 64-bit Arm is one of NEON, not of the baseline with itself.
#[cfg(target_arch = "aarch64")]
#[test]
fn the_widest_level_of_a_64_bit_arm_is_neon() {
    assert_eq!(Level::widest().to_string(), "neon");
}
