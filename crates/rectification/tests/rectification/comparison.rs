//! Shifts of blocks against known ones.

use fastrand::Rng;
use fmc_rectification::comparison::{BLOCK_PX, GreyDifference, Plane, ShiftSummary, shifts};
use fmc_rectification::pattern::{Wave, Waves};

/// Returns waves of random periods from 12 to 200 px, directions and phases.
pub(crate) fn waves(rng: &mut Rng) -> Waves {
    let wave = |rng: &mut Rng| Wave {
        period_px: 12.0 * (200.0_f64 / 12.0).powf(rng.f64()),
        direction_rad: rng.f64() * std::f64::consts::TAU,
        phase_rad: rng.f64() * std::f64::consts::TAU,
        amplitude: 4500.0,
    };
    Waves {
        mean: 32_000.0,
        waves: (0..6).map(|_| wave(rng)).collect(),
    }
}

fn image(waves: &Waves, side: usize, [dx, dy]: [f64; 2], gain: f64) -> Vec<f32> {
    let mut values = Vec::new();
    for row in 0..side {
        for col in 0..side {
            let place = [col as f64 - dx, row as f64 - dy];
            values.push((waves.value(place, 0) * gain + 100.0) as f32);
        }
    }
    values
}

#[test]
fn shifts_of_noiseless_waves_are_found_within_a_thousandth_of_a_pixel() {
    let mut rng = Rng::with_seed(2);
    let side = 3 * BLOCK_PX;
    let mut largest = [0.0_f64; 2];
    for round in 0..24 {
        let waves = waves(&mut rng);
        let most = [0.04, 2.0][round % 2];
        let shift = [0, 1].map(|_| most * (2.0 * rng.f64() - 1.0));
        let a = image(&waves, side, [0.0, 0.0], 1.0);
        let b = image(&waves, side, shift, 0.97);
        let a = Plane::new(side, &a, None).unwrap();
        let b = Plane::new(side, &b, None).unwrap();
        let blocks = shifts(&a, &b);
        assert_eq!(blocks.len(), 9);
        for block in blocks {
            let [dx, dy] = block.shift_px.unwrap();
            let error = (dx - shift[0]).hypot(dy - shift[1]);
            largest[round % 2] = largest[round % 2].max(error);
        }
    }
    println!("{largest:?}");
    assert!(largest[0] <= 1e-4 && largest[1] <= 5e-4, "{largest:?}");
}

#[test]
fn blocks_without_texture_or_pixels_have_no_shift_and_say_so() {
    let flat = vec![7.0_f32; 128 * 64];
    let mut rng = Rng::with_seed(2);
    let textured = image(&waves(&mut rng), 128, [0.0, 0.0], 1.0);
    let textured = &textured[..128 * 64];
    let stripes: Vec<f32> = (0..128 * 64)
        .map(|index| (index % 128) as f32 * 3.0)
        .collect();
    let nothing = vec![0_u8; 128 * 64];
    let summary = |values: &[f32], mask| {
        let plane = Plane::new(128, values, mask).unwrap();
        let mut summary = ShiftSummary::default();
        for block in shifts(&plane, &plane) {
            summary.add(&block);
        }
        (summary.found, summary.not_found, summary.rms_px())
    };
    assert_eq!(summary(&flat, None), (0, 2, None));
    assert_eq!(summary(&stripes, None), (0, 2, None));
    assert_eq!(summary(textured, Some(&nothing)), (0, 2, None));
    assert_eq!(summary(textured, None), (2, 0, Some(0.0)));
    assert!(Plane::new(100, &flat, None).is_none());
    assert_eq!(GreyDifference::default().rms(), None);
}

#[test]
fn grey_differences_add_up() {
    let mut all = GreyDifference::default();
    let mut part = GreyDifference::default();
    all.add(10.0, 13.0);
    part.add(10.0, 9.0);
    all.merge(&part);
    assert_eq!((all.count, all.largest, all.mean()), (2, 3.0, Some(1.0)));
    assert!((all.rms().unwrap() - 5.0_f64.sqrt()).abs() < 1e-12);
}
