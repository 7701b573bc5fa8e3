//! Matching against known shifts.

use fmc_composition::image::Plane;
use fmc_composition::image::matching::{MatchOptions, find};

const OPTIONS: MatchOptions = MatchOptions {
    half_px: [24, 24],
    search_px: 4,
    affine: true,
    least_correlation: 0.8,
};

fn number(value: usize) -> f64 {
    f64::from(u32::try_from(value).unwrap())
}

/// Texture of periods of 12 px and more, moved, sheared, brighter and with more contrast.
fn texture(shift: [f64; 2], shear: f64, gain: f64) -> Plane {
    Plane::of_rows(160, 160, |row| {
        (0..160)
            .map(|col| {
                let (x, y) = (number(col) - 80.0, number(row) - 80.0);
                let (x, y) = (x - shift[0] - shear * y, y - shift[1] + shear * x);
                let waves = [
                    (12.0, 0.3),
                    (17.0, 2.1),
                    (29.0, 1.2),
                    (53.0, 4.0),
                    (21.0, 5.0),
                ];
                let sum: f64 = waves
                    .iter()
                    .map(|(period, turn)| {
                        let along: f64 = x * f64::cos(*turn) + y * f64::sin(*turn);
                        (std::f64::consts::TAU * along / period + turn).sin()
                    })
                    .sum();
                fmc_composition::grey(gain * (6000.0 + 900.0 * sum))
            })
            .collect()
    })
}

#[test]
fn same_content_is_found_within_0_01_px() {
    let a = texture([0.0; 2], 0.0, 1.0);
    let mut largest: f64 = 0.0;
    for (shift, shear) in [
        ([0.5, -0.5], 0.0),
        ([2.31, 1.77], 0.0),
        ([-3.25, 0.1], 0.002),
        ([1.05, -2.9], -0.01),
    ] {
        let b = texture(shift, shear, 1.3);
        let found = find(&a, [80, 80], &b, [80.0, 80.0], &OPTIONS).unwrap();
        // A place x of a lies where x_b - shift ∓ shear·y_b = x.
        let error = [found.place_px[0] - 80.0, found.place_px[1] - 80.0];
        let expected = {
            let (dx, dy) = (shift[0], shift[1]);
            let scale = 1.0 + shear * shear;
            [(dx + shear * dy) / scale, (dy - shear * dx) / scale]
        };
        let off = (error[0] - expected[0]).hypot(error[1] - expected[1]);
        largest = largest.max(off);
        assert!(found.correlation > 0.999, "{}", found.correlation);
    }
    assert!(largest < 0.01, "{largest} px");
}

#[test]
fn nothing_is_found_without_contrast_or_content_or_the_same_content() {
    let a = texture([0.0; 2], 0.0, 1.0);
    let flat = Plane::of_rows(160, 160, |_| vec![5000; 160]);
    assert_eq!(find(&a, [80, 80], &flat, [80.0, 80.0], &OPTIONS), None);
    assert_eq!(find(&flat, [80, 80], &a, [80.0, 80.0], &OPTIONS), None);
    let mut holed = texture([0.0; 2], 0.0, 1.0);
    holed.values_mut()[80 * 160 + 80] = 0;
    assert_eq!(find(&a, [80, 80], &holed, [80.0, 80.0], &OPTIONS), None);
    let other = texture([40.0, 33.0], 0.3, 1.0);
    assert_eq!(find(&a, [80, 80], &other, [80.0, 80.0], &OPTIONS), None);
    assert_eq!(
        find(&a, [10, 80], &a, [10.0, 80.0], &OPTIONS),
        None,
        "leaves the image"
    );
}
