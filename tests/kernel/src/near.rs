//! Points of ordinary cameras so near to the principal point that products of their coordinates
//! fall below 2⁻¹²⁶.

use crate::arithmetic::Arithmetic;
use crate::check::{self, Bound, Difference, MOST};
use crate::corners::CAMERA;
use crate::random::Generator;

/// Number of points.
const POINTS: usize = 100_000;
/// Bound of the differences. Where such numbers count as zero, each of the thirty operations adds
/// less than 2⁻¹²⁶ mm to the result: coefficients are below one, and so are lengths unless rounding
/// hides the difference. The last subtraction may then round the other way, which adds a unit in
/// the last place.
const BOUND: Bound = Bound {
    difference_mm: 32.0 * f32::MIN_POSITIVE,
    up_to_mm: 1e-21,
};

/// Compares with IEEE arithmetic; returns how many points differ, which must be none where the
/// kernel's arithmetic is the same.
///
/// # Errors
/// The first [`Difference`] beyond the bound.
pub(crate) fn compare() -> Result<usize, Difference> {
    let mut generator = Generator(0x6c07_8965);
    let mut points = [[0.0; 2]; MOST];
    // K0, the decentring and the principal point would hide the products to be tested.
    let mut form = CAMERA;
    [form.cx, form.cy, form.k0, form.hx, form.hy] = [0.0; 5];
    [form.tx, form.ty] = [0.0; 2];
    let mut compared = 0;
    let mut different = 0;
    while compared < POINTS {
        for point in &mut points {
            *point = [tiny(&mut generator), tiny(&mut generator)];
        }
        different += check::within(&form, &points, BOUND)?;
        compared += points.len();
    }
    match crate::arithmetic::OF_KERNEL {
        Arithmetic::Gradual if different > 0 => {
            Err(Difference::of_count("points differ", different))
        }
        // Without a difference the test of the bound would be empty.
        Arithmetic::Flushing if different == 0 => Err(Difference::of_count("points differ", 0)),
        _ => Ok(different),
    }
}

/// Returns zero, or a number of either sign from 2⁻¹⁴⁹ up to 64 mm, every power of two being as
/// likely.
fn tiny(generator: &mut Generator) -> f32 {
    let [sign, exponent, mantissa @ ..] = generator.next().to_le_bytes();
    let [low, middle] = mantissa;
    let exponent = u32::from(exponent) % 133;
    let bits =
        u32::from(sign & 1) << 31 | exponent << 23 | u32::from(low) << 14 | u32::from(middle);
    if sign & 0xf0 == 0 {
        0.0
    } else {
        f32::from_bits(bits)
    }
}
