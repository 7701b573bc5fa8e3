//! The records of frames, their number, and the latest frame.

use crate::flight::camera;
use crate::flight::fault::Faults;
use crate::flight::frame_record::{Flags, Outcome, Reason};
#[cfg(feature = "link")]
use crate::flight::record_log::Extent;
use crate::flight::record_log::{Entry, Numbered, RecordLog};
use crate::flight::time::Time;

/// Records and counts of the frames.
#[derive(Debug, Clone)]
pub(in super::super) struct Kept {
    /// Number and frame of the last recorded exposure.
    latest: Option<(u32, camera::Frame)>,
    records: RecordLog,
    triggers: u32,
    exposed: u32,
    refused: u32,
    unexpected_edges: u32,
}

impl Kept {
    #[inline]
    pub(super) const fn new() -> Self {
        Self {
            latest: None,
            records: RecordLog::new(),
            triggers: 0,
            exposed: 0,
            refused: 0,
            unexpected_edges: 0,
        }
    }

    /// Forgets all that is kept, where it is: it is the largest part of a controller.
    pub(super) fn restart(&mut self) {
        let Self {
            latest,
            records,
            triggers,
            exposed,
            refused,
            unexpected_edges,
        } = self;
        *latest = None;
        records.restart();
        for count in [triggers, exposed, refused, unexpected_edges] {
            *count = 0;
        }
    }

    /// Takes over counts and numbers of a flight that a reset has ended.
    #[cfg(feature = "link")]
    pub(in super::super) fn resume(&mut self, counts: [u32; 4], records: &Extent) {
        [
            self.triggers,
            self.exposed,
            self.refused,
            self.unexpected_edges,
        ] = counts;
        self.records.resume(records);
    }

    /// Numbers a trigger. Every trigger gets a number and a record; one without room for its record
    /// is refused at once.
    pub(in super::super) fn number(&mut self, trigger: Time) -> Numbered {
        self.triggers = self.triggers.saturating_add(1);
        let numbered = self.records.number(trigger);
        if let Numbered::Full(_) = numbered {
            self.refused = self.refused.saturating_add(1);
        }
        numbered
    }

    /// Records a trigger that was refused.
    pub(in super::super) fn refuse(
        &mut self,
        sequence: u32,
        trigger: Time,
        reason: Reason,
        faults: Faults,
    ) {
        self.finish(Entry {
            sequence,
            trigger,
            outcome: Outcome::Refused(reason),
            faults,
            flags: Flags::NONE,
        });
    }

    /// Finishes the record of a trigger.
    pub(super) fn finish(&mut self, record: Entry) {
        let count = match record.outcome {
            Outcome::Exposed(_) => &mut self.exposed,
            Outcome::Refused(_) => &mut self.refused,
        };
        *count = count.saturating_add(1);
        self.records.finish(record);
    }

    /// Keeps the frame of an exposure, so that its points can be corrected.
    pub(super) const fn set_latest(&mut self, sequence: u32, frame: camera::Frame) {
        self.latest = Some((sequence, frame));
    }

    /// Forgets the frame of the last exposure; its record stays.
    pub(in super::super) const fn forget_latest(&mut self) {
        self.latest = None;
    }

    /// Counts an edge of the shutter that the camera had not commanded.
    pub(super) const fn count_unexpected_edge(&mut self) {
        self.unexpected_edges = self.unexpected_edges.saturating_add(1);
    }

    pub(in super::super) const fn latest(&self) -> Option<&(u32, camera::Frame)> {
        self.latest.as_ref()
    }

    pub(in super::super) const fn records(&self) -> &RecordLog {
        &self.records
    }

    pub(in super::super) const fn records_mut(&mut self) -> &mut RecordLog {
        &mut self.records
    }

    /// Numbers of triggers, of records with an exposure, of records without, and of edges of the
    /// shutter that the camera had not commanded.
    pub(in super::super) const fn counts(&self) -> [u32; 4] {
        [
            self.triggers,
            self.exposed,
            self.refused,
            self.unexpected_edges,
        ]
    }
}
