//! The way back: slices against single points, and the number of points that are replaced.

use core::array::from_fn;
use core::hint::black_box;

use fmc_camera_kernel::Coefficients;
use fmc_camera_kernel::inverse::{self, LastStep};

use crate::arithmetic::Arithmetic;
use crate::check::{Difference, MOST};
use crate::random::Generator;

/// Number of points.
const POINTS: usize = 1_000_000;

/// A frame whose first step is the last for most points of the sensor.
const LAST_STEP: LastStep = LastStep {
    longest2_mm2: 1e-4,
    farthest_mm: [59.0, 59.5],
};

/// Compares random points; returns their number.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn compare() -> Result<usize, Difference> {
    let mut generator = Generator(0x1d87_2b41);
    let mut compared = 0;
    let mut whole = 0_usize;
    while compared < POINTS {
        let form = generator.form(false);
        // A camera's coefficients, of which those in the generator are the largest.
        let form = form.map(|number| 0.01 * number);
        // Within 40 mm all points end; beyond, the points behind the first that does not stay.
        let reach = if whole.is_multiple_of(2) { 40.0 } else { 59.6 };
        let mut points = [[0.0; 2]; MOST];
        for point in &mut points {
            *point = from_fn(|_| generator.number(reach, false));
        }
        let length = MOST - usize::from(generator.next().to_le_bytes()[1]);
        let (points, _) = points.split_at_mut(length);
        compare_form::<false>("distort, short", &form, points)?;
        compare_form::<true>("distort, full", &form, points)?;
        compared += length;
        whole += 1;
    }
    Ok(compared)
}

fn compare_form<const FULL: bool>(
    what: &'static str,
    form: &Coefficients,
    points: &[[f32; 2]],
) -> Result<(), Difference> {
    let mut memory = [[0.0; 2]; MOST];
    let (found, _) = memory.split_at_mut(points.len());
    found.copy_from_slice(points);
    let (form_of_all, last_step) = (black_box(form), black_box(&LAST_STEP));
    let in_blocks = inverse::blocks::<FULL>(form_of_all, last_step, found);
    let behind = found.get_mut(in_blocks..).unwrap_or_default();
    let replaced = in_blocks + inverse::pairs::<FULL>(form_of_all, last_step, behind);
    let mut expected = [[0.0; 2]; MOST];
    let (expected, _) = expected.split_at_mut(points.len());
    expected.copy_from_slice(points);
    let mut ended = 0;
    Arithmetic::Gradual.run(|| {
        for point in expected.iter_mut() {
            let step = black_box(black_box(form).first_step::<FULL>(black_box(*point)));
            if !LAST_STEP.ends(step.step2_mm2, step.measured) {
                break;
            }
            *point = step.measured;
            ended += 1;
        }
    });
    if replaced != ended {
        return Err(Difference::of_count(what, replaced));
    }
    let both = found.as_flattened().iter().zip(expected.as_flattened());
    for (index, (found, expected)) in both.enumerate() {
        if found.to_bits() != expected.to_bits() {
            return Err(Difference {
                what,
                points: points.len(),
                index,
                found: found.to_bits(),
                expected: expected.to_bits(),
            });
        }
    }
    Ok(())
}
