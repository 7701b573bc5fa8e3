//! Single finding of a judgement.

use fmc_camera::flight::frame_record::Outcome;

use super::flown::Flown;
use crate::wording;

/// A finding.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Subject of the finding.
    pub what: String,
    /// Result.
    pub found: String,
    /// `true` if the result is as it should be.
    pub passed: bool,
}

/// Judges the number of refused triggers, which is at most `most`.
pub(super) fn refused(flown: &Flown, most: usize) -> Finding {
    let refused = flown
        .frames
        .iter()
        .filter(|frame| matches!(frame.record.outcome, Outcome::Refused(_)))
        .count();
    Finding {
        what: match most {
            0 => "no trigger refused".to_owned(),
            most => format!("at most {} refused", wording::counted(most, "trigger")),
        },
        found: format!("{refused} refused"),
        passed: refused <= most,
    }
}
