//! Hypotenuse in whole numbers, for cores without double precision.

/// Bits behind the last place of the longer side's square.
const GUARD_BITS: u32 = 14;

/// Bits of the upper half of the sum, which is rounded: at least 29 of them are significant, and
/// the lowest one stands for all below it.
const UPPER_BITS: u32 = 32;

/// Difference of the exponents from which the shorter side does not matter.
const NEGLIGIBLE: u32 = 25;

/// Returns √(x² + y²).
///
/// # Model
/// That of `libm::hypotf`: the sum of the squares is rounded once, and so is its root. `libm` adds
/// them in double precision, which a Cortex-M4F has to emulate by 3 kB of code; here the squares of
/// the significands are added in 63 bits, of which the upper half is rounded.
///
/// # Accuracy
/// Within a unit in the last place. The bits are those of `libm`, which rounds the sum to double
/// precision first, but for one pair in some hundred million. A longer side below 2⁻¹²⁶ is the
/// result.
///
/// An infinite side makes it infinite, whatever the other is; otherwise a NaN makes it a NaN.
pub(super) fn hypotenuse(x: f32, y: f32) -> f32 {
    let (x, y) = (x.abs(), y.abs());
    let (longer, shorter) = if x.to_bits() >= y.to_bits() {
        (x, y)
    } else {
        (y, x)
    };
    if shorter.is_infinite() {
        // Behind the infinity come the NaNs.
        return shorter;
    }
    let (long, exponent) = parts(longer);
    let (short, short_exponent) = parts(shorter);
    let difference = exponent - short_exponent;
    if !longer.is_normal() || difference >= NEGLIGIBLE {
        return longer;
    }
    let square = |side: u32| (u64::from(side) * u64::from(side)) << GUARD_BITS;
    let (long, short) = (square(long), square(short));
    let shift = 2 * difference;
    let shifted = short >> shift;
    let sum = long + shifted;
    let is_cut = short.trailing_zeros() < shift || sum.trailing_zeros() < UPPER_BITS;
    let upper = (sum >> UPPER_BITS) as u32 | u32::from(is_cut);
    #[expect(clippy::cast_precision_loss, reason = "it is rounded as documented")]
    let root = fmc_camera_kernel::sqrt(upper as f32);
    // The root of the sum has 31 or 32 bits in front of its point, 7 of them behind the longer
    // side's last place, which is that of 2⁻¹⁵⁰ at the exponent 0; that of its upper half has 16
    // fewer.
    let bits = root.to_bits() + (exponent << 23) - ((150 + GUARD_BITS / 2 - UPPER_BITS / 2) << 23);
    f32::from_bits(bits.min(f32::INFINITY.to_bits()))
}

/// Returns the significand of a positive number, and its exponent.
fn parts(number: f32) -> (u32, u32) {
    let bits = number.to_bits();
    let fraction = bits & ((1 << 23) - 1);
    match bits >> 23 {
        0 => (fraction, 1),
        exponent => (fraction | 1 << 23, exponent),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::hypotenuse;

    fn assert_is_that_of_libm(x: f32, y: f32) {
        let (found, expected) = (hypotenuse(x, y), libm::hypotf(x, y));
        let is_same =
            found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
        assert!(is_same, "({x:e}, {y:e}): {found:e}, {expected:e}");
    }

    #[test]
    fn sides_without_end_or_number_or_length_are_as_in_libm() {
        let sides = [
            0.0,
            -0.0,
            f32::MIN_POSITIVE,
            1.0,
            3.0,
            4.0,
            f32::MAX,
            f32::MAX / 2.0,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        for x in sides {
            for y in sides {
                assert_is_that_of_libm(x, y);
            }
        }
        assert_eq!(hypotenuse(3.0, -4.0).to_bits(), 5.0_f32.to_bits());
        assert!(hypotenuse(f32::MAX, f32::MAX).is_infinite());
        let tiny = f32::MIN_POSITIVE / 2.0;
        assert_eq!(hypotenuse(tiny, -tiny).to_bits(), tiny.to_bits());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn any_sides_have_the_hypotenuse_of_libm(
            x in 0.5_f32..1.0,
            y in 0.5_f32..1.0,
            scale in -90_i32..127,
            ratio in -30_i32..=0,
        ) {
            let x = libm::ldexpf(x, scale);
            let y = libm::ldexpf(y, scale + ratio);
            assert_is_that_of_libm(x, y);
            assert_is_that_of_libm(-y, x);
        }
    }
}
