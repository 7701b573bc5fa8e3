//! The way back: bits of the first step in all vectors, and points at which it is not the last.

use fmc_camera_kernel::host::{Batch, Level};
use fmc_camera_kernel::inverse::LastStep;
use fmc_camera_kernel::{Coefficients, Terms};

use crate::call::{FORM, TERMS, assert_same};

/// Number in the memory behind a slice, which must not be written.
const BESIDE: f32 = -77.25;

const LAST_STEP: LastStep = LastStep {
    longest2_mm2: 1e-14,
    farthest_mm: [38.0, 31.0],
};

/// Returns measured x and y, NaN and y where the first step is not the last, and the distortion.
fn portable(
    form: &Coefficients,
    terms: Terms,
    last_step: &LastStep,
    x: &[f32],
    y: &[f32],
) -> [Vec<f32>; 4] {
    let mut found = [(); 4].map(|()| Vec::with_capacity(x.len()));
    for (x, y) in x.iter().zip(y) {
        let step = match terms {
            Terms::Short => form.first_step::<false>([*x, *y]),
            Terms::Full => form.first_step::<true>([*x, *y]),
        };
        let [mut x, y] = step.measured;
        if !last_step.ends(step.step2_mm2, step.measured) {
            x = f32::NAN;
        }
        let [dx, dy] = step.distortion;
        for (numbers, number) in found.iter_mut().zip([x, y, dx, dy]) {
            numbers.push(number);
        }
    }
    found
}

/// Asserts that every level has the bits of the portable step, and says whether all points end.
fn assert_levels_are_the_same(
    form: Coefficients,
    last_step: &LastStep,
    x: &[f32],
    y: &[f32],
) -> bool {
    let mut all_end = false;
    for terms in TERMS {
        let expected = portable(&form, terms, last_step, x, y);
        all_end = !expected[0].iter().any(|x| x.is_nan());
        for level in Level::all() {
            let batch = Batch::new(form, terms).at(level);
            let mut found = [(); 4].map(|()| vec![BESIDE; x.len() + 1]);
            let [found_x, found_y, dx, dy] = found.each_mut().map(|numbers| {
                let (numbers, _) = numbers.split_at_mut(x.len());
                numbers
            });
            let ended = batch.xy_distorted(last_step, [x, y], [found_x, found_y], [dx, dy]);
            assert_eq!(ended, all_end, "{level}, {} points", x.len());
            for (found, expected) in found.iter().zip(&expected) {
                let (beside, found) = found.split_last().unwrap();
                assert_eq!(beside.to_bits(), BESIDE.to_bits());
                assert_same(&format!("{level}, {terms:?}"), [x, y], found, expected);
            }
        }
    }
    all_end
}

#[test]
fn a_million_random_points_have_the_bits_of_the_portable_step() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut about = |size: f32| size * (2.0 * random.f32() - 1.0);
    let x: Vec<f32> = (0..1_000_000).map(|_| about(40.0)).collect();
    let y: Vec<f32> = (0..1_000_000).map(|_| about(40.0)).collect();
    let strong = Coefficients { k1: 9e-5, ..FORM };
    for form in [FORM, strong] {
        let all_end = assert_levels_are_the_same(form, &LAST_STEP, &x, &y);
        assert!(!all_end, "some points are off the sensor");
    }
    let free = LastStep {
        longest2_mm2: f32::MAX,
        farthest_mm: [f32::MAX; 2],
    };
    assert!(assert_levels_are_the_same(FORM, &free, &x, &y));
}

#[test]
fn any_bits_are_numbers_that_give_the_bits_of_the_portable_step() {
    let mut random = fastrand::Rng::with_seed(78);
    let mut any = || f32::from_bits(random.u32(..));
    let x: Vec<f32> = (0..200_000).map(|_| any()).collect();
    let y: Vec<f32> = (0..200_000).map(|_| any()).collect();
    assert_levels_are_the_same(FORM, &LAST_STEP, &x, &y);
}

#[test]
fn one_point_that_does_not_end_is_seen_wherever_it_stands() {
    for length in (1..70).chain([127, 128, 129]) {
        let (mut x, y) = (vec![1.0; length], vec![-2.0; length]);
        assert!(assert_levels_are_the_same(FORM, &LAST_STEP, &x, &y));
        for index in [0, length / 2, length - 1] {
            for off in [38.1, f32::NAN, f32::NEG_INFINITY] {
                x[index] = off;
                assert!(!assert_levels_are_the_same(FORM, &LAST_STEP, &x, &y));
            }
            x[index] = 1.0;
        }
    }
    assert!(assert_levels_are_the_same(FORM, &LAST_STEP, &[], &[]));
}
