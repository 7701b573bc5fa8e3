//! Numbers in the fields of a sentence, read without a float parser: digits, at most one point.

/// Digits of a number that are read; further digits behind the point are ignored, below 1e-8 of the
/// number.
const MAX_DIGITS: u32 = 9;

/// Powers of ten, each exact in single precision.
const POWERS: [(u32, f32); 10] = [
    (1, 1.0),
    (10, 10.0),
    (100, 100.0),
    (1000, 1000.0),
    (10_000, 10_000.0),
    (100_000, 100_000.0),
    (1_000_000, 1_000_000.0),
    (10_000_000, 10_000_000.0),
    (100_000_000, 100_000_000.0),
    (1_000_000_000, 1_000_000_000.0),
];

/// Whole numbers up to here are exact in single precision.
const EXACT: u32 = 1 << 24;

/// Binary places by which a number with more digits is scaled before the division: enough for 26
/// bits of any quotient.
const SCALE_BITS: u32 = 31;

/// Factor that removes the scale, exactly.
const UNSCALE: f32 = 1.0 / (65_536.0 * 32_768.0);

/// Returns the number of a field, rounded to nearest; `None` if the field is empty or holds
/// anything but digits, a leading minus and one point.
///
/// # Accuracy
/// The nearest `f32` of the first nine digits, as the core library's parser gives it.
pub(super) fn single(field: &[u8]) -> Option<f32> {
    let (is_negative, digits) = match field.split_first() {
        Some((b'-', rest)) => (true, rest),
        _ => (false, field),
    };
    let (whole, places) = decimal(digits)?;
    let (divisor, power) = POWERS.get(places)?;
    let size = if whole <= EXACT {
        #[expect(clippy::cast_precision_loss, reason = "exact up to 2^24")]
        let whole = whole as f32;
        whole / power
    } else {
        let scaled = u64::from(whole) << SCALE_BITS;
        let divisor = u64::from(*divisor);
        let sticky = u64::from(!scaled.is_multiple_of(divisor));
        #[expect(
            clippy::cast_precision_loss,
            reason = "the only rounding, to nearest: the last bit says whether there was more"
        )]
        let quotient = ((scaled / divisor) | sticky) as f32;
        quotient * UNSCALE
    };
    Some(if is_negative { -size } else { size })
}

/// Returns a field's digits as a whole number, and how many of them stand behind the point.
fn decimal(field: &[u8]) -> Option<(u32, usize)> {
    let (mut whole, mut places) = (0_u32, 0_usize);
    let (mut kept, mut has_digit, mut has_point) = (0, false, false);
    for byte in field {
        match byte {
            b'0'..=b'9' => {
                has_digit = true;
                if kept < MAX_DIGITS && places < MAX_DIGITS as usize {
                    whole = whole * 10 + u32::from(byte - b'0');
                    kept += u32::from(whole > 0);
                    places += usize::from(has_point);
                } else if !has_point {
                    return None;
                }
            }
            b'.' if !has_point => has_point = true,
            _ => return None,
        }
    }
    has_digit.then_some((whole, places))
}

/// Returns the whole number of a field of digits; `None` if it is empty or has more than nine.
pub(super) fn whole(field: &[u8]) -> Option<u32> {
    if field.is_empty() || field.len() > MAX_DIGITS as usize {
        return None;
    }
    field.iter().try_fold(0, |number, byte| match byte {
        b'0'..=b'9' => Some(number * 10 + u32::from(byte - b'0')),
        _ => None,
    })
}

/// Returns the digits behind the point as a whole number of so many places, 0 for an empty field.
/// The field begins with the point; further digits are ignored.
pub(super) fn fraction(field: &[u8], places: u32) -> Option<u32> {
    let Some((point, digits)) = field.split_first() else {
        return Some(0);
    };
    if *point != b'.' || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let mut digits = digits.iter();
    Some((0..places).fold(0, |number, _| {
        number * 10 + digits.next().map_or(0, |digit| u32::from(digit - b'0'))
    }))
}

#[cfg(test)]
mod tests {
    use std::format;

    use proptest::prelude::*;

    use super::{fraction, single, whole};

    proptest! {
        #[test]
        fn number_is_that_of_the_core_librarys_parser(text in "-?[0-9]{1,5}(\\.[0-9]{0,4})?") {
            let parsed: f32 = text.parse().unwrap();
            prop_assert_eq!(single(text.as_bytes()).map(f32::to_bits), Some(parsed.to_bits()));
        }

        #[test]
        fn fraction_alone_is_that_of_the_core_librarys_parser(text in "-?0?\\.[0-9]{1,9}") {
            let parsed: f32 = text.parse().unwrap();
            prop_assert_eq!(single(text.as_bytes()).map(f32::to_bits), Some(parsed.to_bits()));
        }

        #[test]
        fn digits_beyond_the_ninth_do_not_change_the_number(text in "[1-9][0-9]{3}\\.[0-9]{5}", more in "[0-9]{1,20}") {
            let with_more = format!("{text}{more}");
            prop_assert_eq!(single(with_more.as_bytes()), single(text.as_bytes()));
        }
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in [
            "",
            "-",
            ".",
            "-.",
            "1..2",
            "1.2.3",
            "nan",
            "inf",
            "1e3",
            "+1",
            " 1",
            "1234567890",
            "--1",
        ] {
            assert_eq!(single(text.as_bytes()), None, "{text}");
        }
        // Behind the ninth place zeros are left out as other digits are.
        assert_eq!(single(b"0.0000000019"), single(b"0.000000001"));
        assert_eq!(single(b"0.00000000099"), Some(0.0));
        assert_eq!(whole(b"000000012"), Some(12));
        assert_eq!(
            (whole(b""), whole(b"1.0"), whole(b"0000000000")),
            (None, None, None)
        );
        assert_eq!(fraction(b".5", 6), Some(500_000));
        assert_eq!(fraction(b".1234567", 6), Some(123_456));
        assert_eq!((fraction(b"", 6), fraction(b".", 6)), (Some(0), Some(0)));
        assert_eq!((fraction(b"5", 6), fraction(b".5a", 6)), (None, None));
    }
}
