//! Numbers with a fixed count of decimals, as `{:.9}` writes them, in a small part of its time.
//!
//! The code computes what depends on digits and does not branch on it: the digits of measured
//! points are almost random, and a mispredicted branch takes as long as a number.

use std::io::Write as _;

/// Length of the longest number, bytes: sign, eight digits, point, nine decimals.
const LONGEST: usize = 1 + 8 + 1 + 9;

/// Bits that turn eight digits into text.
const ASCII: u64 = u64::from_le_bytes([b'0'; 8]);

/// Appends `value` with `DECIMALS` decimals, at most 9, rounded half to even from its exact binary
/// value.
#[inline]
pub(in crate::formats) fn push<const DECIMALS: u32>(text: &mut Vec<u8>, value: f64) {
    const { assert!(DECIMALS > 0 && DECIMALS <= 9) };
    let Some((whole, decimals)) = parts::<DECIMALS>(value) else {
        let decimals = DECIMALS as usize;
        // Writing to a vector does not fail.
        let _ = write!(text, "{value:.decimals$}");
        return;
    };
    let whole = eight_digits(whole);
    // A bit in the last digit makes zero keep one digit.
    let leading_zeros = (whole | 1 << 56).trailing_zeros() / 8;
    let sign = usize::from(value.is_sign_negative());
    let point = sign + 8 - leading_zeros as usize;
    // Nine decimals are computed; those beyond the wanted ones are cut off.
    let nine = decimals * const { 10_u64.pow(9 - DECIMALS) };
    let [first, ..] = (nine / 100_000_000).to_le_bytes();
    let [digits, eight] = [whole, eight_digits(nine % 100_000_000)].map(|digits| digits | ASCII);
    let end = text.len() + point + 1 + DECIMALS as usize;
    text.extend_from_slice(&[b'-'; LONGEST]);
    if let Some(number) = text.last_chunk_mut() {
        put(number, sign, (digits >> (8 * leading_zeros)).to_le_bytes());
        put(number, point, [b'.', b'0' | first]);
        put(number, point + 2, eight.to_le_bytes());
    }
    text.truncate(end);
}

/// Returns the whole part and the decimals of a number's magnitude; `None` for values that are too
/// large or not numbers.
#[inline]
fn parts<const DECIMALS: u32>(value: f64) -> Option<(u64, u64)> {
    let scale = const { 10_u64.pow(DECIMALS) };
    let bits = value.to_bits();
    let exponent = bits >> 52 & 0x7ff;
    // value = mantissa·2^-shift; a subnormal number is less than half a unit whatever its mantissa.
    let mantissa = bits & 0xf_ffff_ffff_ffff | 1 << 52;
    let shift = 1075_u64.checked_sub(exponent)?;
    match shift {
        // The value is less than 2^26.
        27..64 => {
            let whole = mantissa >> shift;
            let fraction = mantissa << (64 - shift);
            let decimals = shifted(u128::from(fraction) * u128::from(scale), 64);
            if decimals == scale {
                return Some((whole + 1, 0));
            }
            Some((whole, decimals))
        }
        // The value is less than 2^-11, so the decimals do not carry into the whole part.
        64..128 => Some((0, shifted(u128::from(mantissa) * u128::from(scale), shift))),
        128.. => Some((0, 0)),
        _ => None,
    }
}

/// Returns number·2^-shift, rounded half to even; the result fits 64 bits.
#[inline]
fn shifted(number: u128, shift: u64) -> u64 {
    let odd = number >> shift & 1;
    let less_than_half = (1 << (shift - 1)) - 1;
    u64::try_from((number + less_than_half + odd) >> shift).unwrap_or(u64::MAX)
}

/// Returns the eight decimal digits of a number below 1e8, one in each byte, the first in the
/// lowest.
///
/// The number is split into halves of four digits, then of two, then of one, with all parts of a
/// length side by side. The reciprocals of 100 and of 10 give the exact quotient for all numbers of
/// four and of two digits.
#[inline]
const fn eight_digits(number: u64) -> u64 {
    let fours = (number / 10_000) | ((number % 10_000) << 32);
    let hundreds = ((fours * 10_486) >> 20) & 0x7f_0000_007f;
    let twos = hundreds | (fours - 100 * hundreds) << 16;
    let tens = ((twos * 103) >> 10) & 0xf_000f_000f_000f;
    tens | (twos - 10 * tens) << 8
}

#[inline]
fn put<const BYTES: usize>(number: &mut [u8; LONGEST], from: usize, bytes: [u8; BYTES]) {
    if let Some(place) = number.get_mut(from..).and_then(<[u8]>::first_chunk_mut) {
        *place = bytes;
    }
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
            assert_as_formatted(f64::from(fmc_camera_file::number::single(value)));
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
    fn digits_of_every_number_of_four_and_their_neighbours_are_its_own() {
        for number in 0..10_000 {
            for number in [
                number,
                10_000 * number,
                10_001 * number,
                99_999_999 - number,
            ] {
                let bytes = (eight_digits(number) | ASCII).to_le_bytes();
                assert_eq!(String::from_utf8_lossy(&bytes), format!("{number:08}"));
            }
        }
    }

    #[test]
    fn numbers_of_every_length_are_written_as_the_formatter_writes_them() {
        let mut random = fastrand::Rng::with_seed(3);
        for digits in 0..18 {
            for _ in 0..2_000 {
                let value = 10_f64.powi(digits - 8) * (random.f64() - 0.5);
                assert_as_formatted(value);
                // One unit of the sixth decimal from a round number tests rounding up and its
                // carry.
                assert_as_formatted(value.round() - 1e-6);
                assert_as_formatted(value.round() - 4e-10);
            }
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
            67_108_864.0_f64.next_down(),
            67_108_864.0,
            100_000_000.0_f64.next_down(),
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
