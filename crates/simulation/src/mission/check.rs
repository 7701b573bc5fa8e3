//! Single check of a judgement.

use fmc_camera::flight::frame_record::Outcome;

use super::flown::Flown;
use crate::wording;

/// A check.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Subject of the check.
    pub what: String,
    /// Result.
    pub found: String,
    /// `true` if the result is as it should be.
    pub passed: bool,
    /// `true` if there was nothing to judge, which is no pass.
    pub is_vacuous: bool,
}

impl Check {
    /// Creates a check of so many cases, which the noun names; over none it has failed.
    pub(super) fn over(
        (cases, noun): (usize, &str),
        what: String,
        found: String,
        passed: bool,
    ) -> Self {
        if cases == 0 {
            return Self {
                what,
                found: format!("0 {noun}s: nothing to judge"),
                passed: false,
                is_vacuous: true,
            };
        }
        Self {
            what,
            found,
            passed,
            is_vacuous: false,
        }
    }
}

/// Judges the number of refused triggers, which is at most `most`.
pub(super) fn refused(flown: &Flown, most: usize) -> Check {
    let refused = flown
        .frames
        .iter()
        .filter(|frame| matches!(frame.record.outcome, Outcome::Refused(_)))
        .count();
    Check::over(
        (flown.frames.len(), "record"),
        match most {
            0 => "no trigger refused".to_owned(),
            most => format!("at most {} refused", wording::counted(most, "trigger")),
        },
        format!("{refused} refused"),
        refused <= most,
    )
}
