//! Edges of the source image.

use fmc_camera_kernel::host::Level;
use fmc_camera_kernel::resampling::{Band, Kernel, PLACE_BITS, Resampler, Run};

use crate::image::Image;

const UNIT: i32 = 1 << PLACE_BITS;

fn image() -> Image<u16> {
    let mut number = 0;
    Image::new([64, 64], 3, || {
        number += 7919;
        (number % 50_000) as u16 + 1000
    })
}

/// Returns one pixel at a place, 1/2²⁴ px, of an image, and its mask.
fn pixel(image: &Image<u16>, resampler: &Resampler, place: [i64; 2]) -> ([u16; 3], u8) {
    let run = Run {
        base_px: place.map(|place| (place >> PLACE_BITS) as i32),
        start: place.map(|place| (place & i64::from(UNIT - 1)) as i32),
        step: [UNIT, 0],
        count: 1,
        border: false,
    };
    let (out, mask, border) = image.row(resampler, &[run]);
    assert_eq!(border, u32::from(mask[0] == 0));
    ([out[0], out[1], out[2]], mask[0])
}

#[test]
fn beyond_the_outermost_centre_the_edge_counts_and_beyond_the_edge_nothing() {
    let image = image();
    let half = i64::from(UNIT / 2);
    let last = 63 * i64::from(UNIT);
    for kernel in Kernel::ALL {
        for level in Level::all() {
            let resampler = Resampler::new(kernel).at(level);
            let at = |place| pixel(&image, &resampler, place);
            let value = |col: usize, row: usize| {
                let start = 3 * (row * 64 + col);
                [0, 1, 2].map(|band| image.samples[start + band])
            };
            for by in [0, 1, half / 3, half] {
                assert_eq!(at([-by, -by]), (value(0, 0), 1), "{kernel}, {by}");
                assert_eq!(
                    at([last + by, last + by]),
                    (value(63, 63), 1),
                    "{kernel}, {by}"
                );
                let inner = 20 * i64::from(UNIT);
                assert_eq!(at([inner, -by]), (value(20, 0), 1), "{kernel}, {by}");
                assert_eq!(at([last + by, inner]), (value(63, 20), 1), "{kernel}, {by}");
            }
            for place in [
                [-half - 1, last / 2],
                [last + half + 1, last / 2],
                [last / 2, -half - 1],
                [last / 2, last + half + 1],
            ] {
                assert_eq!(at(place), ([0; 3], 0), "{kernel}");
            }
        }
    }
}

#[test]
fn taps_over_the_edge_take_the_edge_s_value() {
    let image = image();
    for kernel in Kernel::ALL {
        for level in Level::all() {
            let resampler = Resampler::new(kernel).at(level);
            for col in 0..64 {
                for row in [0, 1, 2, 31, 61, 62, 63] {
                    let share = [0.25, 0.5, 0.75][col % 3];
                    let place = [col as f64 + share, f64::from(row) + 0.25];
                    let steps = place.map(|place| (place * f64::from(UNIT)) as i64);
                    let (found, mask) = pixel(&image, &resampler, steps);
                    if place[0] > 63.5 {
                        assert_eq!(mask, 0);
                        continue;
                    }
                    for (band, found) in found.into_iter().enumerate() {
                        let error = f64::from(found) - image.exact(kernel, place, band);
                        // Random samples: a rounding of a weight counts with their whole range.
                        assert!(error.abs() <= 12.0, "{kernel}, {place:?}: {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn pixels_behind_the_last_run_are_border() {
    let image = image();
    let rows: Vec<&[u16]> = image.samples.chunks(192).collect();
    let band = Band::new([64, 64], 3, 0, &rows).unwrap();
    let run = Run {
        base_px: [10, 10],
        step: [UNIT, 0],
        count: 16,
        ..Run::default()
    };
    let (mut out, mut mask) = (vec![9; 60], vec![9; 20]);
    let border = Resampler::new(Kernel::Bilinear).row(&band, &[run], &mut out, &mut mask);
    assert_eq!(border, 4);
    assert!(out[48..].iter().all(|sample| *sample == 0) && mask[16..] == [0; 4]);
    assert!(mask[..16] == [1; 16]);
}

#[test]
fn a_band_of_other_rows_than_the_image_has_is_refused() {
    let row = [0_u8; 12];
    let rows = [row.as_slice(); 3];
    assert!(Band::new([4, 3], 3, 0, &rows).is_some());
    assert!(Band::new([5, 3], 3, 0, &rows).is_none());
    assert!(Band::new([6, 3], 2, 0, &rows).is_none(), "two bands");
    assert!(Band::new([4, 0], 3, 0, &rows).is_none());
}
