//! Conversion of numbers from text and to the precision of the camera.

/// Parses a finite number.
///
/// # Errors
/// A message for the user.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("not a finite number".to_owned()),
    }
}

/// Returns as much of a text as a message can show.
#[must_use]
pub fn clipped(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// Rounds a number to the precision of the camera.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding to the camera's precision is the purpose; what becomes infinite is refused by validation"
)]
#[must_use]
pub const fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_finite_number_is_refused() {
        assert_eq!(finite(" -1e-3 "), Ok(-1e-3));
        for text in ["", "nan", "inf", "1e999", "1/200", "x"] {
            assert!(finite(text).is_err(), "{text}");
        }
    }

    #[test]
    fn long_text_is_clipped_between_its_letters() {
        assert_eq!(clipped("0.1"), "0.1");
        assert_eq!(clipped(&"é".repeat(61)), format!("{}…", "é".repeat(60)));
    }
}
