//! Numbers on the command line, and in the precision of the camera.

/// A finite number.
///
/// # Errors
/// A sentence for the user.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("not a finite number".to_owned()),
    }
}

/// An exposure time in seconds, or a fraction such as 1/200.
///
/// # Errors
/// A sentence for the user; zero and negative times are not exposures.
pub fn exposure_time(text: &str) -> Result<f64, String> {
    let seconds = match text.split_once('/') {
        Some((numerator, denominator)) => finite(numerator)? / finite(denominator)?,
        None => finite(text)?,
    };
    if seconds > 0.0 && seconds.is_finite() {
        Ok(seconds)
    } else {
        Err("not a positive time in seconds".to_owned())
    }
}

/// Largest noise of a simulation, µm.
pub const MAX_NOISE_UM: f64 = 1000.0;

/// A standard deviation in µm, 0 to [`MAX_NOISE_UM`].
///
/// # Errors
/// A sentence for the user with the range.
pub fn noise_um(text: &str) -> Result<f64, String> {
    match finite(text) {
        Ok(noise) if (0.0..=MAX_NOISE_UM).contains(&noise) => Ok(noise),
        Ok(_) => Err(format!("outside 0 to {MAX_NOISE_UM} µm")),
        Err(_) => Err(format!("not a number from 0 to {MAX_NOISE_UM} µm")),
    }
}

/// As much of a text as belongs into a message.
#[must_use]
pub fn clipped(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    }
}

/// A number in the precision of the camera.
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
    fn seconds_and_fractions_are_times() {
        assert_eq!(exposure_time("0.005"), Ok(0.005));
        assert_eq!(exposure_time("1/200"), Ok(0.005));
        assert_eq!(exposure_time(" 1 / 200 "), Ok(0.005));
        assert_eq!(exposure_time("5e-3"), Ok(0.005));
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
