//! Numbers with a power of ten, for labels.

/// Returns the exponent of ten that leaves one digit before the point.
pub(super) fn exponent(number: f64) -> i32 {
    if number.abs() > 0.0 && number.is_finite() {
        crate::figure::pixels(number.abs().log10().floor())
    } else {
        0
    }
}

/// Writes a power of ten, `10⁻⁹`.
pub(super) fn power_of_ten(exponent: i32) -> String {
    let digits = exponent.to_string();
    let raised = digits.chars().map(|digit| match digit {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        _ => '⁹',
    });
    format!("10{}", raised.collect::<String>())
}

/// Writes a value with two digits of its standard deviation, `(9.23 ± 0.04)·10⁻⁸`.
pub(super) fn with_deviation(value: f64, deviation: f64) -> String {
    let exponent = exponent(value.abs().max(deviation));
    let scale = 10.0_f64.powi(-exponent);
    let decimals = (1 - self::exponent(deviation * scale)).clamp(0, 9);
    let decimals = usize::try_from(decimals).unwrap_or(0);
    let number = format!(
        "({:.decimals$} ± {:.decimals$})",
        value * scale,
        deviation * scale
    );
    if exponent == 0 {
        number
    } else {
        format!("{number}·{}", power_of_ten(exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_written_as_by_hand() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(power_of_ten(exponent(9.2e-8)), "10⁻⁸");
        assert_eq!(exponent(0.0), 0);
    }

    #[test]
    fn deviation_decides_the_digits() {
        assert_eq!(with_deviation(9.226e-8, 1.4e-10), "(9.226 ± 0.014)·10⁻⁸");
        assert_eq!(
            with_deviation(-1e-9, 3.7e-6),
            "(0.0 ± 3.7)·10⁻⁶".replace("(0.0", "(-0.0")
        );
        assert_eq!(with_deviation(1.5, 0.0), "(1.5 ± 0.0)");
    }
}
