//! Grey values against double precision.

use fastrand::Rng;
use fmc_camera_kernel::resampling::{Kernel, Resampler};

use crate::image::{Image, places, runs};

/// Largest difference of a kernel's result from the rounded one of double precision on 1/f texture,
/// counts of 16 bits: by the rounding of weights to 14 bits and, for tables, of places to 1/4096
/// px.
const LARGEST: [(Kernel, f64); 5] = [
    (Kernel::Nearest, 0.0),
    (Kernel::Bilinear, 1.0),
    (Kernel::Bicubic, 5.0),
    (Kernel::Keys6, 5.0),
    (Kernel::Lanczos3, 5.0),
];

/// Returns an image whose amplitude is inversely proportional to the frequency: octaves of equal
/// amplitude, noise that is interpolated linearly.
fn texture(size_px: [u32; 2], bands: usize) -> Image<u16> {
    let mut rng = Rng::with_seed(5);
    let [width, height] = size_px.map(|side| side as usize);
    let mut values = vec![0.0; width * height * bands];
    for octave in 0..7 {
        let period = 1_usize << octave;
        let (cols, rows) = (width / period + 2, height / period + 2);
        let noise: Vec<f64> = (0..cols * rows * bands).map(|_| rng.f64() - 0.5).collect();
        for (index, value) in values.iter_mut().enumerate() {
            let (band, pixel) = (index % bands, index / bands);
            let (col, row) = (pixel % width, pixel / width);
            let at = |c: usize, r: usize| {
                noise[((row / period + r) * cols + col / period + c) * bands + band]
            };
            let share = |place: usize| (place % period) as f64 / period as f64;
            let (x, y) = (share(col), share(row));
            let upper = at(0, 0) * (1.0 - x) + at(1, 0) * x;
            let lower = at(0, 1) * (1.0 - x) + at(1, 1) * x;
            *value += (upper * (1.0 - y) + lower * y) * 10_000.0;
        }
    }
    let mut values = values.into_iter();
    Image::new(size_px, bands, || {
        (values.next().unwrap() + 32768.0)
            .round()
            .clamp(0.0, 65535.0) as u16
    })
}

#[test]
fn grey_values_are_those_of_double_precision_within_a_count_or_five() {
    let mut rng = Rng::with_seed(7);
    let image = texture([400, 120], 3);
    for (kernel, limit) in LARGEST {
        let resampler = Resampler::new(kernel);
        let (mut largest, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
        for _ in 0..150 {
            let start = [rng.f64() * 4.0, 4.0 + rng.f64() * 110.0];
            let step = [0.98 + 0.04 * rng.f64(), 0.02 * (rng.f64() - 0.5)];
            let row = runs(&mut rng, start, step, 380);
            let (out, ..) = image.row(&resampler, &row);
            for (pixel, place) in out.as_chunks::<3>().0.iter().zip(places(&row)) {
                for (band, found) in pixel.iter().enumerate() {
                    let error = f64::from(*found) - image.exact(kernel, place, band).round();
                    largest = largest.max(error.abs());
                    squares += error * error;
                    count += 1.0;
                }
            }
        }
        println!(
            "{kernel}: {largest:.2} counts, rms {:.3}",
            (squares / count).sqrt()
        );
        assert!(largest <= limit, "{kernel}: {largest}");
    }
}

#[test]
fn overshoot_beside_an_edge_saturates() {
    let mut number = 0;
    let image = Image::<u16>::new([64, 16], 1, || {
        number += 1;
        if number / 8 % 2 == 0 { 0 } else { 65535 }
    });
    let mut rng = Rng::with_seed(1);
    let row = runs(&mut rng, [8.3, 8.0], [1.0, 0.0], 40);
    for kernel in [Kernel::Bicubic, Kernel::Keys6, Kernel::Lanczos3] {
        let (out, ..) = image.row(&Resampler::new(kernel), &row);
        assert!(
            out.contains(&0) && out.contains(&65535),
            "{kernel}: {out:?}"
        );
        for (found, place) in out.iter().zip(places(&row)) {
            let error = f64::from(*found) - image.exact(kernel, place, 0);
            assert!(error.abs() <= 40.0, "{kernel}, {place:?}: {error}");
        }
    }
}
