//! Exaggeration of the arrows of a field.

use crate::arrow::{Arrow, length_of};
use crate::wording;

/// Longest arrow, in grid spacings.
const LONGEST: f64 = 0.9;
/// Shorter arrows, in grid spacings, are drawn as points.
const SHORTEST: f64 = 0.06;
/// Longest sample arrow, in grid spacings.
const SAMPLE: f64 = 2.0;

/// Exaggeration of a field's arrows, from its longest one and the spacing of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ArrowScale {
    /// Mean distance of neighbouring points.
    pub(crate) spacing_mm: f64,
    /// Drawn length by true length; 0 if every displacement is zero.
    exaggeration: f64,
}

impl ArrowScale {
    /// Returns a scale at which no arrow reaches the next point.
    pub(crate) fn fitting(
        [width_mm, height_mm]: [f64; 2],
        lengths_mm: impl ExactSizeIterator<Item = f64>,
    ) -> Self {
        let intervals = (count(lengths_mm.len()).sqrt() - 1.0).max(1.0);
        let spacing_mm = (width_mm * height_mm).sqrt() / intervals;
        let longest = lengths_mm.filter(|mm| mm.is_finite()).fold(0.0, f64::max);
        let exaggeration = if longest > 0.0 {
            two_digits_of(LONGEST * spacing_mm / longest)
        } else {
            0.0
        };
        Self {
            spacing_mm,
            exaggeration,
        }
    }

    /// Returns true if an arrow is long enough to be drawn as one.
    pub(crate) fn shows(&self, arrow: &Arrow) -> bool {
        length_of(self.drawn_mm(arrow.displacement_mm)) >= SHORTEST * self.spacing_mm
    }

    /// Returns a displacement as drawn.
    pub(crate) fn drawn_mm(&self, displacement_mm: [f64; 2]) -> [f64; 2] {
        displacement_mm.map(|part| part * self.exaggeration)
    }

    /// Returns true and drawn length of a sample arrow: 1, 2 or 5 of a decade.
    pub(crate) fn sample(&self) -> Option<(f64, f64)> {
        if self.exaggeration <= 0.0 {
            return None;
        }
        let longest = SAMPLE * self.spacing_mm / self.exaggeration;
        let decade = decade_of(longest);
        let factor = [5.0, 2.0]
            .into_iter()
            .find(|factor| factor * decade <= longest)
            .unwrap_or(1.0);
        let sample = factor * decade;
        Some((sample, sample * self.exaggeration))
    }

    pub(crate) fn exaggeration_text(&self) -> String {
        let number = wording::grouped(&wording::decimals(self.exaggeration, 2));
        format!("arrows drawn {number} times their length")
    }
}

fn decade_of(number: f64) -> f64 {
    10.0_f64.powf(number.log10().floor())
}

/// Rounds down to two digits, so that the number stated is the number used.
fn two_digits_of(number: f64) -> f64 {
    let unit = decade_of(number) / 10.0;
    (number / unit).floor() * unit
}

#[expect(clippy::cast_precision_loss, reason = "counts far below 2^53")]
fn count(number: usize) -> f64 {
    number as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(longest_mm: f64) -> ArrowScale {
        ArrowScale::fitting([80.0, 80.0], vec![longest_mm; 441].into_iter())
    }

    #[test]
    fn longest_arrow_stays_within_the_grid_spacing() {
        for longest in [3e-6, 0.04, 0.577, 12.0] {
            let scale = scale(longest);
            assert!((scale.spacing_mm - 4.0).abs() < 1e-12);
            let [drawn, _] = scale.drawn_mm([longest, 0.0]);
            assert!(
                drawn > 0.8 * 4.0 && drawn <= 0.9 * 4.0,
                "{longest}: {drawn}"
            );
        }
    }

    #[test]
    fn sample_is_round_and_fits() {
        let (sample, drawn) = scale(0.04).sample().unwrap();
        assert!((sample - 0.05).abs() < 1e-12);
        assert!(drawn <= 2.0 * 4.0);
        assert_eq!(scale(0.0).sample(), None);
    }

    #[test]
    fn exaggeration_is_stated_with_two_digits() {
        assert_eq!(
            scale(0.04).exaggeration_text(),
            "arrows drawn 90 times their length"
        );
        assert_eq!(
            scale(3e-5).exaggeration_text(),
            "arrows drawn 120,000 times their length"
        );
    }
}
