//! Numbers as the files have them.

/// Significant digits, which give every number of double precision back.
const DIGITS: usize = 17;

/// Formats a number with up to 17 significant digits, always with a decimal point, and with a
/// signed exponent if it is very small or very large: readers of YAML 1.1 take `1e-5` for a word.
#[must_use]
pub fn number(value: f64) -> String {
    let scientific = format!("{value:.*e}", DIGITS - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if let Ok(before_point) = usize::try_from(exponent)
        && before_point < DIGITS
    {
        return shortened(&format!("{value:.*}", DIGITS - 1 - before_point));
    }
    if (-4..0).contains(&exponent) {
        let decimals = DIGITS - 1 + usize::try_from(-exponent).unwrap_or(0);
        return shortened(&format!("{value:.decimals$}"));
    }
    let sign = if exponent < 0 { '-' } else { '+' };
    format!(
        "{}e{sign}{:02}",
        shortened(mantissa),
        exponent.unsigned_abs()
    )
}

/// Formats numbers with commas between.
#[must_use]
pub fn list(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|value| number(*value)).collect();
    words.join(", ")
}

/// Removes zeros at the end, but for the one after the point.
fn shortened(digits: &str) -> String {
    if !digits.contains('.') {
        return format!("{digits}.0");
    }
    let digits = digits.trim_end_matches('0');
    if digits.ends_with('.') {
        format!("{digits}0")
    } else {
        digits.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_comes_back_bit_for_bit() {
        let mut value = 1.234_567_890_123_456_7e-30_f64;
        while value < 1e30 {
            for value in [value, -value, 1.0 / value] {
                let text = number(value);
                assert_eq!(
                    text.parse::<f64>().unwrap().to_bits(),
                    value.to_bits(),
                    "{text}"
                );
                assert!(text.contains('.'), "{text}");
            }
            value *= 1.7;
        }
    }

    #[test]
    fn number_is_short_where_it_can_be() {
        assert_eq!(number(0.0), "0.0");
        assert_eq!(number(14204.0), "14204.0");
        assert_eq!(number(-0.5), "-0.5");
        assert_eq!(number(1e-5), "1.0000000000000001e-05");
        assert_eq!(number(2f64.powi(70)), "1.1805916207174113e+21");
        assert_eq!(list(&[1.0, 0.25]), "1.0, 0.25");
    }
}
