//! Numbers on the command line.

use fmc_camera_file::number::finite;

/// Reads an exposure time in seconds, or a fraction such as 1/200.
///
/// # Errors
/// A sentence for the user; times must be positive.
pub(super) fn exposure_time(text: &str) -> Result<f64, String> {
    match quotient(text)? {
        seconds if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        _ => Err("not a positive time in seconds".to_owned()),
    }
}

/// Reads a number, or a fraction such as 70/700.
///
/// # Errors
/// A sentence for the user; the number must be finite.
pub(super) fn number_or_fraction(text: &str) -> Result<f64, String> {
    match quotient(text)? {
        number if number.is_finite() => Ok(number),
        _ => Err("a fraction over zero".to_owned()),
    }
}

/// Reads a positive number.
///
/// # Errors
/// A sentence for the user.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    match finite(text)? {
        number if number > 0.0 => Ok(number),
        _ => Err("not a positive number".to_owned()),
    }
}

/// Reads a number, or one over another.
fn quotient(text: &str) -> Result<f64, String> {
    match text.split_once('/') {
        Some((numerator, denominator)) => Ok(finite(numerator)? / finite(denominator)?),
        None => finite(text),
    }
}

/// Returns a reader of numbers from `least` to `most`.
pub(super) fn between(
    least: f64,
    most: f64,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| match finite(text) {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!("not a number from {least} to {most}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_and_fractions_are_times() {
        assert_eq!(exposure_time("0.005"), Ok(0.005));
        assert_eq!(exposure_time("1/200"), Ok(0.005));
        assert_eq!(exposure_time(" 1 / 200 "), Ok(0.005));
        assert_eq!(exposure_time("5e-3"), Ok(0.005));
    }

    #[test]
    fn numbers_and_fractions_of_either_sign_are_numbers() {
        assert_eq!(number_or_fraction("0.1"), Ok(0.1));
        assert_eq!(number_or_fraction("70/700"), Ok(0.1));
        assert_eq!(number_or_fraction("-70 / 700"), Ok(-0.1));
        for text in ["", "1/0", "0/0", "nan", "inf", "70/", "/700", "7/7/7"] {
            assert!(number_or_fraction(text).is_err(), "{text}");
        }
        assert_eq!(positive("700"), Ok(700.0));
        for text in ["0", "-1", "nan", "inf", ""] {
            assert!(positive(text).is_err(), "{text}");
        }
    }

    #[test]
    fn ends_are_between_and_no_number_is_not() {
        let read = between(0.0, 1000.0);
        assert_eq!(read("0"), Ok(0.0));
        assert_eq!(read("1e3"), Ok(1000.0));
        for text in ["-0.1", "1000.1", "nan", "inf", "", "x"] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in [
            "", "1/0", "0", "-1/200", "nan", "inf", "1/nan", "1/2/3", "fast", "1/",
        ] {
            assert!(exposure_time(text).is_err(), "{text}");
        }
    }
}
