//! Numbers with a fixed count of decimals, as `{:.9}` writes them, in a tenth of its time.

use std::io::Write as _;

/// Beyond it the scaled number may not fit 64 bits.
const LARGEST: f64 = 1e9;

/// Appends `value` with `DECIMALS` decimals, at most 9, rounded half to even from its exact binary value.
pub(super) fn push<const DECIMALS: u32>(text: &mut Vec<u8>, value: f64) {
    const { assert!(DECIMALS > 0 && DECIMALS <= 9) };
    let scale = const { 10_u64.pow(DECIMALS) };
    let bits = value.to_bits();
    let exponent = bits >> 52 & 0x7ff;
    // value = mantissa·2^-shift; a subnormal number is less than half a unit whatever its mantissa.
    let shift = 1075_u64.saturating_sub(exponent);
    if value.is_nan() || value.abs() >= LARGEST || shift == 0 {
        let decimals = DECIMALS as usize;
        // Writing to a vector does not fail.
        let _ = write!(text, "{value:.decimals$}");
        return;
    }
    let mantissa = bits & 0xf_ffff_ffff_ffff | 1 << 52;
    let scaled = u128::from(mantissa) * u128::from(scale);
    let rounded = if shift < 128 {
        let whole = scaled >> shift;
        let rest = scaled - (whole << shift);
        let half = 1 << (shift - 1);
        let up = rest > half || rest == half && whole & 1 == 1;
        whole + u128::from(up)
    } else {
        0
    };
    // Less than 1e9 scaled by at most 1e9.
    let rounded = u64::try_from(rounded).unwrap_or(u64::MAX);
    if value.is_sign_negative() {
        text.push(b'-');
    }
    let mut digits = itoa::Buffer::new();
    text.extend_from_slice(digits.format(rounded / scale).as_bytes());
    // A one before the decimals keeps their zeros, and gives its place to the point.
    let decimals = digits.format(scale + rounded % scale).as_bytes();
    text.push(b'.');
    text.extend_from_slice(decimals.get(1..).unwrap_or_default());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_as_formatted(value: f64) {
        let mut text = Vec::new();
        push::<9>(&mut text, value);
        assert_eq!(
            String::from_utf8_lossy(&text),
            format!("{value:.9}"),
            "{value:e}"
        );
        text.clear();
        push::<6>(&mut text, value);
        assert_eq!(
            String::from_utf8_lossy(&text),
            format!("{value:.6}"),
            "{value:e}"
        );
        text.clear();
        push::<1>(&mut text, value);
        assert_eq!(
            String::from_utf8_lossy(&text),
            format!("{value:.1}"),
            "{value:e}"
        );
    }

    #[test]
    fn coordinates_are_written_as_the_formatter_writes_them() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..300_000 {
            let value = 500.0 * (random.f64() - 0.5);
            assert_as_formatted(value);
            assert_as_formatted(f64::from(crate::formats::number::single(value)));
            assert_as_formatted(value * 1e-6);
        }
    }

    #[test]
    fn any_bits_are_written_as_the_formatter_writes_them() {
        let mut random = fastrand::Rng::with_seed(2);
        for _ in 0..300_000 {
            assert_as_formatted(f64::from_bits(random.u64(..)));
        }
    }

    #[test]
    fn ties_edges_and_zeros_are_written_as_the_formatter_writes_them() {
        for eighths in -4000..4000 {
            assert_as_formatted(f64::from(eighths) / 8.0);
            // Ties at the ninth decimal: odd multiples of 2⁻¹⁰.
            assert_as_formatted(f64::from(eighths) / 1024.0);
        }
        for value in [
            0.0,
            -0.0,
            5e-324,
            -5e-324,
            5e-10,
            -5e-10,
            1e-9,
            0.999_999_999_5,
            9.999_999_999_9,
            999_999_999.999_999_9,
            1e9,
            -1e9,
            1e15,
            4_503_599_627_370_496.0,
            1e300,
            f64::MAX,
            f64::MIN_POSITIVE,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ] {
            assert_as_formatted(value);
        }
    }
}
