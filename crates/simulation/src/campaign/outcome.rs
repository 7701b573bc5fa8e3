//! Outcome of one run, as a line of text.

use std::fmt;
use std::num::ParseIntError;

/// The largest part of what a record allows that an error takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantified {
    /// Name of the quantity.
    pub name: &'static str,
    /// Part of what is allowed; above 1 the frame is silently wrong.
    pub used: f64,
}

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Time from the onset to the first round in which the camera was told something else than
    /// without the fault, ms; `None` if it never was: the fault has not arrived.
    pub arrived_ms: Option<u32>,
    /// First effect; `none` without one.
    pub effect: String,
    /// Its time after the onset, ms.
    pub effect_ms: Option<u32>,
    /// Worst error of the frames without fault or flag; `None` without such frames.
    pub worst: Option<Quantified>,
    /// Number of frames that are wrong without a flag, or record light that did not pass.
    pub silent: u32,
    /// Number of the first of them.
    pub first_silent: Option<u32>,
    /// Number of exposures of which no record tells.
    pub unrecorded: u32,
    /// Number of triggers without their record, and of records without their trigger.
    pub unanswered: u32,
    /// Number of frames that were judged.
    pub exposed: u32,
}

/// Names that [`Quantified`] may have.
const NAMES: [&str; 4] = ["principal point", "UTC", "smear", "V/H"];

impl Outcome {
    /// Name without an effect.
    pub const NO_EFFECT: &'static str = "none";

    /// Returns the number of exposures that are wrong and say nothing of it.
    #[must_use]
    pub const fn silent_bad(&self) -> u32 {
        self.silent.saturating_add(self.unrecorded)
    }

    /// Reads the line that [`Self`] is written as; `None` for another text.
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let mut fields = line.split('|');
        let mut next = || fields.next();
        let arrived_ms = number(next()?).ok()?;
        let effect = next()?.to_owned();
        let effect_ms = number(next()?).ok()?;
        let (name, used) = (next()?, next()?);
        let worst = match (name, used) {
            ("", "") => None,
            _ => Some(Quantified {
                name: NAMES.into_iter().find(|known| *known == name)?,
                used: used.parse().ok()?,
            }),
        };
        let outcome = Self {
            arrived_ms,
            effect,
            effect_ms,
            worst,
            silent: next()?.parse().ok()?,
            first_silent: number(next()?).ok()?,
            unrecorded: next()?.parse().ok()?,
            unanswered: next()?.parse().ok()?,
            exposed: next()?.parse().ok()?,
        };
        fields.next().is_none().then_some(outcome)
    }
}

/// Reads a number that may be missing.
fn number(text: &str) -> Result<Option<u32>, ParseIntError> {
    if text.is_empty() {
        return Ok(None);
    }
    text.parse().map(Some)
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let optional = |value: Option<u32>| value.map_or(String::new(), |value| value.to_string());
        let (name, used) = self.worst.map_or((String::new(), String::new()), |worst| {
            // As many digits as lead back to the same number.
            (worst.name.to_owned(), format!("{:?}", worst.used))
        });
        write!(
            f,
            "{}|{}|{}|{name}|{used}|{}|{}|{}|{}|{}",
            optional(self.arrived_ms),
            self.effect,
            optional(self.effect_ms),
            self.silent,
            optional(self.first_silent),
            self.unrecorded,
            self.unanswered,
            self.exposed
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcome_is_read_back_as_it_was_written_and_a_torn_line_is_none() {
        let full = Outcome {
            arrived_ms: Some(3),
            effect: "flag V/H jump".to_owned(),
            effect_ms: Some(120),
            worst: Some(Quantified {
                name: "smear",
                used: 0.1 + 0.2,
            }),
            silent: 1,
            first_silent: Some(40),
            unrecorded: 0,
            unanswered: 2,
            exposed: 4,
        };
        let empty = Outcome {
            arrived_ms: None,
            effect: Outcome::NO_EFFECT.to_owned(),
            effect_ms: None,
            worst: None,
            first_silent: None,
            ..full.clone()
        };
        for outcome in [full, empty] {
            let line = outcome.to_string();
            assert_eq!(Outcome::parse(&line), Some(outcome));
            // A shorter number is a number: torn lines are told by the sum of their block.
            let torn = line.rsplit_once('|').unwrap().0;
            assert_eq!(Outcome::parse(torn), None, "{torn}");
        }
    }
}
