//! Answers to triggers: which have their record, and which records and exposures belong to none.

use fmc_camera::flight::frame_record::{FrameRecord, Outcome, Reason};

/// Counts of triggers and records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Answers {
    /// Number of triggers.
    pub triggers: usize,
    /// Number of triggers that have their record, in order.
    pub answered: usize,
    /// Number of records without a trigger.
    pub extra: usize,
}

impl Answers {
    /// Counts the triggers, at these times on the camera's clock, µs, that have their record at
    /// their own time, numbered without a gap. Of triggers refused because the camera's memory was
    /// full, all but the last may have the time of the first.
    pub fn of<'a>(
        triggers_us: &[u64],
        records: impl ExactSizeIterator<Item = &'a FrameRecord>,
    ) -> Self {
        let extra = records.len().saturating_sub(triggers_us.len());
        let answered = triggers_us
            .iter()
            .zip(records)
            .zip(1_u32..)
            .filter(|((trigger_us, record), number)| {
                let is_full = record.outcome == Outcome::Refused(Reason::RecordsFull);
                let is_its_time = record.trigger.us() == **trigger_us
                    || is_full && record.trigger.us() < **trigger_us;
                record.sequence == *number && is_its_time
            })
            .count();
        Self {
            triggers: triggers_us.len(),
            answered,
            extra,
        }
    }

    /// Returns the number of triggers without their record.
    #[must_use]
    pub const fn missing(&self) -> usize {
        self.triggers - self.answered
    }

    /// Returns true if every trigger has its record and every record its trigger.
    #[must_use]
    pub const fn are_complete(&self) -> bool {
        self.missing() == 0 && self.extra == 0
    }
}
