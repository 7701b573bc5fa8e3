//! Watch over the unit of a source.

use super::finding::{VhFindingKind, WrongUnit};
use super::refusal::Refusal;

/// Largest difference of a ratio from a unit's factor, as a part of it, at which the unit counts as
/// wrong.
pub const UNIT_TOLERANCE: f32 = 0.03;

/// Largest difference from another way to the same number, as a part of it, at which a source that
/// had the wrong unit is trusted again.
pub const UNIT_RELEASE: f32 = 0.1;

/// A source with a wrong unit: its last value, and the ratio of that value to the right one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Barred {
    unit: WrongUnit,
    value: f32,
    ratio: f32,
}

/// Numbers with which a value is compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct Comparison {
    /// The value that follows from all other sources.
    pub(super) expected: Option<f32>,
    /// The same, if the source is not known to be right.
    pub(super) from_others: Option<f32>,
    /// The source's last value, if it has jumped.
    pub(super) from_past: Option<f32>,
}

/// The unit of a source, as far as it is known to be wrong.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct UnitWatch {
    barred: Option<Barred>,
}

impl UnitWatch {
    pub(super) const NEW: Self = Self { barred: None };

    /// Bars the source, whose value the others have shown to be in the wrong unit.
    pub(super) const fn bar(&mut self, unit: WrongUnit, value: f32) {
        self.barred = Some(Barred {
            unit,
            value,
            ratio: unit.factor(),
        });
    }

    /// Checks the unit of a value against its own past, against the others, and against a unit that
    /// was wrong before.
    pub(super) fn check(
        &mut self,
        unit: WrongUnit,
        value: f32,
        comparison: &Comparison,
    ) -> Result<(), Refusal> {
        let Comparison {
            expected,
            from_others,
            from_past,
        } = *comparison;
        if let Some(barred) = self.barred {
            let confirmed = expected
                .is_some_and(|expected| (value - expected).abs() <= UNIT_RELEASE * expected.abs());
            // The value is nearer to the right one than to the wrong one.
            let back = if barred.ratio > 1.0 {
                value * value * barred.ratio < barred.value * barred.value
            } else {
                value * value * barred.ratio > barred.value * barred.value
            };
            if !(confirmed || back && value > 0.0) {
                // The barred value follows while the aircraft climbs.
                if value > 0.0 {
                    self.barred = Some(Barred { value, ..barred });
                }
                return Err(Refusal {
                    kind: VhFindingKind::WrongUnit(barred.unit),
                    expected,
                });
            }
            self.barred = None;
        }
        let factor = unit.factor();
        let found = [
            (from_others, factor),
            (from_past, factor),
            (from_past, 1.0 / factor),
        ]
        .into_iter()
        .find_map(|(right, ratio)| {
            right
                .filter(|right| is_times(value, *right, ratio))
                .map(|right| (right, ratio))
        });
        let Some((right, ratio)) = found else {
            return Ok(());
        };
        self.barred = Some(Barred { unit, value, ratio });
        Err(Refusal {
            kind: VhFindingKind::WrongUnit(unit),
            expected: Some(right),
        })
    }
}

/// Returns `true` if a value is about `ratio` times the right one.
pub(super) fn is_times(value: f32, right: f32, ratio: f32) -> bool {
    let expected = ratio * right;
    right > 0.0 && (value - expected).abs() <= UNIT_TOLERANCE * expected
}
