//! Numbers as the certificate states them: the text and the number of JSON are the same.

use std::fmt;

use serde::{Serialize, Serializer};

/// A finite number with the digits that are stated.
///
/// It is rounded once: its text stands in the PDF and in the HTML, and the number that this text
/// reads as stands in `certificate.json`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stated {
    text: String,
}

impl Stated {
    /// States a number with so many decimals; `None` if it is not finite.
    #[must_use]
    pub fn decimals(value: f64, decimals: usize) -> Option<Self> {
        Self::of(value, format!("{value:.decimals$}"))
    }

    /// States a number with at most so many digits other than leading zeros, as [`Self::exact`]
    /// does; `None` if it is not finite.
    #[must_use]
    pub fn digits(value: f64, digits: usize) -> Option<Self> {
        let rounded = format!("{value:.*e}", digits.saturating_sub(1));
        Self::exact(rounded.parse().ok()?)
    }

    /// States a number with all its digits, as a power of ten where it is below 0.001 or not below
    /// a million; `None` if it is not finite.
    #[must_use]
    pub fn exact(value: f64) -> Option<Self> {
        Self::of(value, plain(value).unwrap_or_else(|| format!("{value:e}")))
    }

    /// States a whole number.
    #[must_use]
    pub fn count(value: u64) -> Self {
        Self {
            text: value.to_string(),
        }
    }

    fn of(value: f64, text: String) -> Option<Self> {
        let is_zero = !text.contains(|c: char| c.is_ascii_digit() && c != '0');
        // A zero has no sign.
        let text = match text.strip_prefix('-') {
            Some(rest) if is_zero => rest.to_owned(),
            _ => text,
        };
        value.is_finite().then_some(Self { text })
    }

    /// Text as it is printed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Number that the text reads as.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.text.parse().unwrap_or_default()
    }
}

/// Writes a number without a power of ten, if it is neither small nor large.
fn plain(value: f64) -> Option<String> {
    let size = value.abs();
    (size <= 0.0 || (1e-3..1e6).contains(&size)).then(|| format!("{value}"))
}

impl fmt::Display for Stated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Serialize for Stated {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.text.parse::<i64>() {
            Ok(whole) => serializer.serialize_i64(whole),
            Err(_) => serializer.serialize_f64(self.value()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_number_are_the_same() {
        for (stated, text) in [
            (Stated::decimals(-412.3456, 3), "-412.346"),
            (Stated::decimals(-0.0004, 3), "0.000"),
            (Stated::digits(0.000_012_345, 3), "1.23e-5"),
            (Stated::digits(0.3746, 2), "0.37"),
            (Stated::digits(5.000_001e-4, 4), "5e-4"),
            (Stated::exact(51.3712), "51.3712"),
            (Stated::exact(-1.6056e-5), "-1.6056e-5"),
            (Some(Stated::count(52_920)), "52920"),
        ] {
            let stated = stated.unwrap();
            assert_eq!(stated.text(), text);
            let json: f64 = serde_json::from_str(&serde_json::to_string(&stated).unwrap()).unwrap();
            assert_eq!(json.to_bits(), text.parse::<f64>().unwrap().to_bits());
        }
        assert_eq!(Stated::decimals(f64::NAN, 3), None);
        assert_eq!(Stated::exact(f64::INFINITY), None);
    }
}
