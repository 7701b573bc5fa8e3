//! Lengths in readable units.

use crate::wording;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unit {
    Nanometre,
    Micrometre,
    Millimetre,
}

impl Unit {
    /// Returns the smallest unit in which a length needs no more than three digits before the
    /// point.
    fn of(length_mm: f64) -> Self {
        if length_mm.abs() < 1e-3 {
            Self::Nanometre
        } else if length_mm.abs() < 1.0 {
            Self::Micrometre
        } else {
            Self::Millimetre
        }
    }

    pub(crate) const fn symbol(self) -> &'static str {
        match self {
            Self::Nanometre => "nm",
            Self::Micrometre => "µm",
            Self::Millimetre => "mm",
        }
    }

    const fn per_mm(self) -> f64 {
        match self {
            Self::Nanometre => 1e6,
            Self::Micrometre => 1e3,
            Self::Millimetre => 1.0,
        }
    }
}

/// Largest number of decimals in a column.
const MOST_DECIMALS: usize = 3;

/// Unit and decimals that all numbers of a column share, so that they line up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Scale {
    pub(crate) unit: Unit,
    decimals: usize,
}

impl Scale {
    /// Returns the unit that suits the largest length, with decimals that show two digits of the
    /// smallest other than zero.
    pub(crate) fn fitting(lengths_mm: impl IntoIterator<Item = f64>) -> Self {
        let (least, most) = lengths_mm
            .into_iter()
            .map(f64::abs)
            .filter(|length| length.is_finite() && *length > 0.0)
            .fold((f64::INFINITY, 0.0_f64), |(least, most), length| {
                (least.min(length), most.max(length))
            });
        let unit = Unit::of(most);
        let mut decimals = 0;
        let mut threshold = 9.95;
        while decimals < MOST_DECIMALS && least * unit.per_mm() < threshold {
            decimals += 1;
            threshold /= 10.0;
        }
        Self { unit, decimals }
    }

    /// Writes the number alone; the heading names the unit.
    pub(crate) fn number(self, length_mm: f64) -> String {
        let number = length_mm * self.unit.per_mm();
        let text = format!("{number:.*}", self.decimals);
        let shows_zero = text.bytes().all(|byte| matches!(byte, b'0' | b'.'));
        match text.strip_suffix('0') {
            Some(rest) if number > 0.0 && shows_zero => format!("<{rest}1"),
            _ => text,
        }
    }
}

/// Writes a range in µm with one decimal; the heading names the unit.
pub(crate) fn range_um([least, most]: [f64; 2]) -> String {
    format!("{:.1} … {:.1}", 1e3 * least, 1e3 * most)
}

/// Writes a round length with its unit.
pub(crate) fn round(length_mm: f64) -> String {
    let unit = Unit::of(length_mm);
    let number = wording::decimals(length_mm * unit.per_mm(), MOST_DECIMALS);
    format!("{number} {}", unit.symbol())
}

/// Writes a length with its unit and about three digits.
pub(crate) fn text(length_mm: f64) -> String {
    let unit = Unit::of(length_mm);
    let number = length_mm * unit.per_mm();
    let decimals = match number.abs() {
        size if size >= 99.95 || size <= 0.0 => 0,
        size if size >= 9.995 => 1,
        size if size >= 0.0995 => 2,
        size if size >= 0.000_995 => 4,
        _ => return format!("{number:.1e} {}", unit.symbol()),
    };
    format!("{number:.decimals$} {}", unit.symbol())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn column_shares_unit_and_decimals() {
        let scale = Scale::fitting([2.29e-3, 0.057e-3]);
        assert_eq!(scale.unit, Unit::Micrometre);
        assert_eq!(scale.number(2.29e-3), "2.290");
        assert_eq!(scale.number(0.057e-3), "0.057");
        let scale = Scale::fitting([0.43e-6, 0.11e-6, 0.0]);
        assert_eq!(scale.unit, Unit::Nanometre);
        assert_eq!(scale.number(0.43e-6), "0.43");
    }

    #[test]
    fn number_too_small_for_its_column_is_not_zero() {
        let scale = Scale::fitting([2.29e-3, 1e-8]);
        assert_eq!(scale.number(1e-8), "<0.001");
        assert_eq!(scale.number(0.0), "0.000");
    }

    #[test]
    fn column_of_zeros_has_a_scale() {
        assert_eq!(Scale::fitting([0.0]).number(0.0), "0");
    }

    #[test]
    fn length_shows_about_three_digits() {
        assert_eq!(text(0.577_1), "577 µm");
        assert_eq!(text(2.294e-3), "2.29 µm");
        assert_eq!(text(0.434e-6), "0.43 nm");
        assert_eq!(text(0.0), "0 nm");
        assert_eq!(text(2e-12), "2.0e-6 nm");
        assert_eq!(text(1.5), "1.50 mm");
        assert_eq!(round(0.05), "50 µm");
        assert_eq!(round(2.0), "2 mm");
    }
}
