//! Origin of a calibration: what its certificate says beside serial number and version.

use core::fmt;

use heapless::String;

/// Most bytes of the lens.
pub const LENS_BYTES: usize = 32;

/// Most bytes of the laboratory.
pub const LABORATORY_BYTES: usize = 48;

/// Bytes of a date.
pub const DATE_BYTES: usize = 10;

/// Lens, laboratory and day of a calibration. Serial number and version are among the parameters of
/// the camera.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct Origin {
    lens: String<LENS_BYTES>,
    laboratory: String<LABORATORY_BYTES>,
    date: String<DATE_BYTES>,
}

impl Origin {
    /// Returns an origin of these texts, each of which may be empty.
    ///
    /// # Errors
    /// [`OriginError`] for a text that is too long or has control characters, and for a date that
    /// is not a day of the calendar, written as `2026-05-17`.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::io::store::{Origin, OriginError};
    ///
    /// let origin = Origin::new("HR 50 No. 1187", "Universität Hannover", "2026-05-17").unwrap();
    /// assert_eq!(origin.laboratory(), "Universität Hannover");
    /// assert_eq!(Origin::new("", "", "17.5.2026"), Err(OriginError::Date));
    /// ```
    pub fn new(lens: &str, laboratory: &str, date: &str) -> Result<Self, OriginError> {
        let origin = Self {
            lens: String::try_from(lens).map_err(|_| OriginError::LensTooLong)?,
            laboratory: String::try_from(laboratory).map_err(|_| OriginError::LaboratoryTooLong)?,
            date: String::try_from(date).map_err(|_| OriginError::Date)?,
        };
        origin.check()?;
        Ok(origin)
    }

    /// Checks the characters of all texts, which came as bytes.
    pub(super) fn check(&self) -> Result<(), OriginError> {
        let is_text = |text: &str| !text.chars().any(char::is_control);
        if !is_text(&self.lens) || !is_text(&self.laboratory) {
            return Err(OriginError::ControlCharacter);
        }
        if self.date.is_empty() || is_date(self.date.as_bytes()) {
            Ok(())
        } else {
            Err(OriginError::Date)
        }
    }

    /// Lens, as the certificate names it.
    #[must_use]
    pub fn lens(&self) -> &str {
        &self.lens
    }

    /// Laboratory that has calibrated the camera.
    #[must_use]
    pub fn laboratory(&self) -> &str {
        &self.laboratory
    }

    /// Day of the calibration, `2026-05-17`.
    #[must_use]
    pub fn date(&self) -> &str {
        &self.date
    }
}

/// Returns `true` for a day of the Gregorian calendar, year, month and day.
fn is_date(text: &[u8]) -> bool {
    let [y3, y2, y1, y0, b'-', m1, m0, b'-', d1, d0] = text else {
        return false;
    };
    let number = |digits: &[&u8]| {
        let add = |sum: Option<u32>, digit: &&u8| match digit {
            b'0'..=b'9' => Some(sum? * 10 + u32::from(**digit - b'0')),
            _ => None,
        };
        digits.iter().fold(Some(0), add)
    };
    let (Some(year), Some(month), Some(day)) = (
        number(&[y3, y2, y1, y0]),
        number(&[m1, m0]),
        number(&[d1, d0]),
    ) else {
        return false;
    };
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if is_leap => 29,
        2 => 28,
        _ => 0,
    };
    (1..=days).contains(&day)
}

/// The reason why texts are not those of an origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OriginError {
    /// The lens has more than [`LENS_BYTES`].
    LensTooLong,
    /// The laboratory has more than [`LABORATORY_BYTES`].
    LaboratoryTooLong,
    /// A text has a control character.
    ControlCharacter,
    /// The date is not a day, year, month and day, as `2026-05-17`.
    Date,
}

impl fmt::Display for OriginError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LensTooLong => write!(f, "the lens has more than {LENS_BYTES} bytes of UTF-8"),
            Self::LaboratoryTooLong => write!(
                f,
                "the laboratory has more than {LABORATORY_BYTES} bytes of UTF-8"
            ),
            Self::ControlCharacter => f.write_str("lens or laboratory has a control character"),
            Self::Date => f.write_str("the date is not a day as 2026-05-17"),
        }
    }
}

impl core::error::Error for OriginError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_days_of_the_calendar() {
        for date in ["", "2026-05-17", "2024-02-29", "2000-02-29", "1999-12-31"] {
            assert_eq!(Origin::new("", "", date).unwrap().date(), date);
        }
        for date in [
            "2026-02-29",
            "1900-02-29",
            "2026-00-01",
            "2026-13-01",
            "2026-04-31",
            "2026-04-00",
            "2026-4-1",
            "2026/04/01",
            "20260401",
            "2026-04-0a",
            "2026-04-011",
        ] {
            assert_eq!(Origin::new("", "", date), Err(OriginError::Date), "{date}");
        }
    }

    #[test]
    fn texts_are_bounded_and_of_one_line() {
        let long = "0123456789abcdef0123456789abcdef0123456789abcdef";
        assert_eq!(Origin::new("", long, "").unwrap().laboratory(), long);
        let lens = Origin::new(long, "", "");
        assert_eq!(lens, Err(OriginError::LensTooLong));
        let longer = std::format!("{long}!");
        let laboratory = Origin::new("", &longer, "");
        assert_eq!(laboratory, Err(OriginError::LaboratoryTooLong));
        let broken = Origin::new("a\nb", "", "");
        assert_eq!(broken, Err(OriginError::ControlCharacter));
    }
}
