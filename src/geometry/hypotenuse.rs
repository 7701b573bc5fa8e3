//! Hypotenuse in whole numbers, for cores without double precision.

/// Bits of the root behind the unit of the longer side's last place.
const GUARD_BITS: u32 = 7;

/// Returns √(x² + y²).
///
/// # Model
/// The squares of both significands are added in 63 bits, and the integer root of the sum is
/// rounded. `libm::hypotf` does it in double precision, which a Cortex-M4F has to emulate by 3 kB of
/// code.
///
/// # Accuracy
/// The result is the nearest number, to an even significand where two are as near: rounded once,
/// also below 2⁻¹²⁶. `libm` rounds twice, which may differ for one pair in some hundred million.
///
/// An infinite side makes it infinite, whatever the other is; otherwise a NaN makes it a NaN.
pub(super) fn hypotenuse(x: f32, y: f32) -> f32 {
    let (x, y) = (x.abs(), y.abs());
    let (longer, shorter) = if x.to_bits() >= y.to_bits() {
        (x, y)
    } else {
        (y, x)
    };
    if !longer.is_finite() {
        // Behind the infinity come the NaNs.
        return if shorter.is_infinite() { shorter } else { longer };
    }
    let (long, exponent) = parts(longer);
    let (short, short_exponent) = parts(shorter);
    // Of the shorter square, bits that are shifted out cannot reach the root's last one, but tell
    // that it is not exact.
    let square = (short * short) << (2 * GUARD_BITS);
    let shift = 2 * (exponent - short_exponent);
    let shifted = square.checked_shr(shift).unwrap_or(0);
    let is_cut = shifted.checked_shl(shift).unwrap_or(0) != square;
    let (root, rest) = root(((long * long) << (2 * GUARD_BITS)) + shifted);

    let is_beyond = root >> (24 + GUARD_BITS);
    let guard_bits = GUARD_BITS + is_beyond;
    let significand = root >> guard_bits;
    let left = root & ((1 << guard_bits) - 1);
    let half = 1 << (guard_bits - 1);
    let is_odd = significand & 1 != 0;
    let is_up = left > half || (left == half && (is_odd || is_cut || rest != 0));
    // A carry out of the significand raises the exponent, up to that of the infinity.
    let bits = ((exponent - 1 + is_beyond) << 23) + significand + u32::from(is_up);
    f32::from_bits(bits.min(f32::INFINITY.to_bits()))
}

/// Returns the significand of a finite positive number, and the exponent of its last place, plus
/// 150.
fn parts(number: f32) -> (u64, u32) {
    let bits = number.to_bits();
    let fraction = bits & ((1 << 23) - 1);
    match bits >> 23 {
        0 => (u64::from(fraction), 1),
        exponent => (u64::from(fraction | 1 << 23), exponent),
    }
}

/// Returns the integer root of a number below 2⁶³, and what is left of it.
fn root(square: u64) -> (u32, u64) {
    let (mut root, mut rest) = (0_u64, square);
    let mut bit = 1_u64 << 62;
    while bit != 0 {
        let tried = root + bit;
        root >>= 1;
        if rest >= tried {
            rest -= tried;
            root += bit;
        }
        bit >>= 2;
    }
    #[expect(clippy::cast_possible_truncation, reason = "below 2³²")]
    (root as u32, rest)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::hypotenuse;

    fn assert_is_that_of_libm(x: f32, y: f32) {
        let (found, expected) = (hypotenuse(x, y), libm::hypotf(x, y));
        let is_same = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
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
    }

    /// Multiples of the triple (m² - n², 2mn, m² + n²), of which the hypotenuse has 25 bits.
    #[test]
    fn root_in_the_middle_of_two_numbers_is_rounded_to_the_even_one() {
        for (x, y, expected) in [
            // 4096² + 1 and 4096² + 9.
            (16_777_215.0, 8_192.0, 16_777_216.0_f32),
            (16_777_207.0, 24_576.0, 16_777_224.0),
            // 3 · (2000² + 1499²) = 18,741,003.
            (5_258_997.0, 17_988_000.0, 18_741_004.0),
        ] {
            assert_eq!(hypotenuse(x, y).to_bits(), expected.to_bits());
            assert_is_that_of_libm(x, y);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn any_sides_have_the_hypotenuse_of_libm(
            x in 0.5_f32..1.0,
            y in 0.5_f32..1.0,
            scale in -60_i32..60,
            ratio in -30_i32..=0,
        ) {
            let x = libm::ldexpf(x, scale);
            let y = libm::ldexpf(y, scale + ratio);
            assert_is_that_of_libm(x, y);
            assert_is_that_of_libm(-y, x);
        }
    }
}
