//! One thing that a judgement looks at.

use fmc_camera::flight::frame_record::Outcome;

use super::flown::Flown;
use crate::wording;

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What.
    pub what: String,
    /// What was found.
    pub found: String,
    /// Whether that is as it should be.
    pub passed: bool,
}

/// Whether at most so many triggers were refused.
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
