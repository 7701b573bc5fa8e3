//! The records of all triggers, kept until the PC has acknowledged them.

use heapless::Deque;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use super::calibration_id::CalibrationId;
use super::fault::Faults;
use super::frame_record::{Flags, FrameRecord, Outcome, Reason};
use super::in_doubt::InDoubt;
use super::time::Time;

/// Number of a start before which there was none.
pub(crate) const FIRST_BOOT: u32 = 1;

/// Number of whole records that are kept.
pub const CAPACITY: usize = 32;

/// Records in order of their numbers, from the oldest that is not acknowledged to the newest.
///
/// If all [`CAPACITY`] places are taken, triggers are refused as [`Reason::RecordsFull`]; those
/// records differ in number and time alone, and are kept as a range. The range ends with the
/// acknowledgement of its last number, so that it never has a gap.
#[derive(Debug, Clone, Default)]
pub(crate) struct RecordLog {
    whole: Deque<Place, CAPACITY>,
    refused: Option<Range>,
    last_sequence: u32,
    /// Number of the camera's start.
    boot: u32,
    /// A record has changed since `next_unkept` has found none.
    #[cfg_attr(not(feature = "link"), allow(dead_code, reason = "of a link's camera"))]
    has_unkept: bool,
    /// A record has changed since `next_unwritten` has found none.
    #[cfg_attr(
        not(feature = "store"),
        allow(dead_code, reason = "of a camera's store")
    )]
    has_unwritten: bool,
}

/// A record without its calibration, which the controller knows by the record's number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub(crate) struct Entry {
    pub(crate) sequence: u32,
    pub(crate) trigger: Time,
    pub(crate) outcome: Outcome,
    pub(crate) faults: Faults,
    pub(crate) flags: Flags,
}

impl Entry {
    /// A trigger that is refused for want of room, or has not been decided upon.
    const fn without_room(sequence: u32, trigger: Time) -> Self {
        Self {
            sequence,
            trigger,
            outcome: Outcome::Refused(Reason::RecordsFull),
            faults: Faults::NONE,
            flags: Flags::NONE,
        }
    }

    /// The record, made with this calibration.
    pub(crate) const fn record(
        &self,
        calibration: Option<CalibrationId>,
        boot: u32,
        flight: u32,
    ) -> FrameRecord {
        FrameRecord {
            sequence: self.sequence,
            trigger: self.trigger,
            outcome: self.outcome,
            faults: self.faults,
            flags: self.flags,
            calibration,
            boot,
            flight,
        }
    }
}

/// A record, or the place of a pending one.
#[derive(Debug, Clone, Copy)]
struct Place {
    record: Entry,
    /// Number of the start in which the trigger came.
    boot: u32,
    is_pending: bool,
    /// Copy in memory that a reset leaves alone, as it was before the last change.
    #[cfg_attr(not(feature = "link"), allow(dead_code, reason = "of a link's camera"))]
    slot: Option<Slot>,
    /// The copy has the record as it is.
    #[cfg_attr(not(feature = "link"), allow(dead_code, reason = "of a link's camera"))]
    is_kept: bool,
    /// The flash has the record as it is, or is about to.
    #[cfg_attr(
        not(feature = "store"),
        allow(dead_code, reason = "of a camera's store")
    )]
    is_written: bool,
}

/// Number of a place in memory that a reset leaves alone.
pub(crate) type Slot = u8;

/// Number of such places: a record that changes is written beside its old copy.
#[cfg(feature = "link")]
pub(crate) const SLOTS: usize = CAPACITY + 1;

/// A record that is to be copied.
#[cfg(feature = "link")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unkept {
    pub(crate) record: Entry,
    pub(crate) boot: u32,
    pub(crate) is_pending: bool,
    /// A slot without a record that is still wanted.
    pub(crate) slot: Slot,
    /// Its copy from before the change.
    pub(crate) outdated: Option<Slot>,
}

/// Numbers of the records that are not acknowledged.
#[cfg(feature = "link")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Extent {
    /// The oldest; one more than the last where there are none.
    pub(crate) first_left: u32,
    pub(crate) last_sequence: u32,
    pub(crate) refused: Option<Range>,
}

#[cfg(feature = "link")]
impl Extent {
    /// The oldest record that is left, and the range that stands for several.
    pub(crate) const fn left(&self) -> (u32, Option<Range>) {
        (self.first_left, self.refused)
    }
}

/// The number of a trigger.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Numbered {
    /// Its record is to be finished.
    Pending(u32),
    /// There is no room for its record: the trigger is refused.
    Full(u32),
}

/// Triggers refused for want of room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub(crate) struct Range {
    pub(crate) first_sequence: u32,
    last_sequence: u32,
    first: Time,
    last: Time,
    /// Number of the start in which the last trigger came.
    boot: u32,
}

impl Range {
    /// Returns the record of one of them. Between the first and the last, the time is that of the
    /// first.
    fn record(&self, sequence: u32) -> Entry {
        let trigger = if sequence == self.last_sequence {
            self.last
        } else {
            self.first
        };
        Entry::without_room(sequence, trigger)
    }
}

impl RecordLog {
    /// Returns a log before the first trigger.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self {
            whole: Deque::new(),
            refused: None,
            last_sequence: 0,
            boot: FIRST_BOOT,
            has_unkept: false,
            has_unwritten: false,
        }
    }

    /// Forgets all records, and counts from 1 again.
    pub(crate) fn restart(&mut self) {
        self.whole.clear();
        self.refused = None;
        self.last_sequence = 0;
        self.has_unkept = false;
        self.has_unwritten = false;
    }

    /// Numbers a trigger. Its record is pending until [`Self::finish`], and no later one can be
    /// fetched before. Without room, its record is made at once: refused.
    pub(crate) fn number(&mut self, trigger: Time) -> Numbered {
        self.last_sequence = self.last_sequence.saturating_add(1);
        let sequence = self.last_sequence;
        if let Some(range) = &mut self.refused {
            range.last_sequence = sequence;
            range.last = trigger;
            range.boot = self.boot;
            return Numbered::Full(sequence);
        }
        let place = Place {
            record: Entry::without_room(sequence, trigger),
            boot: self.boot,
            is_pending: true,
            slot: None,
            is_kept: false,
            is_written: false,
        };
        if self.whole.push_back(place).is_ok() {
            self.has_unkept = true;
            return Numbered::Pending(sequence);
        }
        self.refused = Some(Range {
            first_sequence: sequence,
            last_sequence: sequence,
            first: trigger,
            last: trigger,
            boot: self.boot,
        });
        Numbered::Full(sequence)
    }

    /// Finishes the record of a pending trigger. Returns `false` if none has that number.
    pub(crate) fn finish(&mut self, record: Entry) -> bool {
        let place = self
            .whole
            .iter_mut()
            .find(|place| place.is_pending && place.record.sequence == record.sequence);
        match place {
            Some(place) => {
                *place = Place {
                    record,
                    is_pending: false,
                    is_kept: false,
                    is_written: false,
                    ..*place
                };
                self.has_unkept = true;
                self.has_unwritten = true;
                true
            }
            None => false,
        }
    }

    /// Marks exposures that are in doubt.
    pub(crate) fn doubt(&mut self, exposures: &InDoubt) {
        for place in &mut self.whole {
            let record = &mut place.record;
            if exposures.contains(record.sequence) {
                record
                    .outcome
                    .doubt(exposures, &mut record.flags, &mut record.faults);
                place.is_kept = false;
                place.is_written = false;
                self.has_unkept = true;
                self.has_unwritten = true;
            }
        }
    }

    /// Number of the last trigger.
    pub(crate) const fn last_sequence(&self) -> u32 {
        self.last_sequence
    }

    /// Number of the oldest record that is not acknowledged; one more than the last where there are
    /// none.
    pub(crate) fn first_left(&self) -> u32 {
        let whole = self.whole.front().map(|place| place.record.sequence);
        let refused = self.refused.as_ref().map(|range| range.first_sequence);
        whole
            .or(refused)
            .unwrap_or_else(|| self.last_sequence.saturating_add(1))
    }

    /// Returns the oldest record with this number or a higher one, and the number of the start in
    /// which its trigger came.
    ///
    /// It returns `None` also if a pending one comes first.
    #[must_use]
    pub(crate) fn from(&self, sequence: u32) -> Option<(Entry, u32)> {
        let mut pending = false;
        for place in &self.whole {
            pending |= place.is_pending;
            if place.record.sequence >= sequence {
                return (!pending).then_some((place.record, place.boot));
            }
        }
        let range = self.refused.as_ref().filter(|_| !pending)?;
        let record = || range.record(sequence.max(range.first_sequence));
        (sequence <= range.last_sequence).then(|| (record(), range.boot))
    }

    /// Forgets the records up to this number, which the PC has, except pending ones and those after
    /// them. Returns the number of those left.
    pub(crate) fn acknowledge(&mut self, through: u32) -> u32 {
        while self
            .whole
            .front()
            .is_some_and(|place| !place.is_pending && place.record.sequence <= through)
        {
            self.whole.pop_front();
        }
        if let Some(range) = self.refused.as_mut().filter(|_| self.whole.is_empty()) {
            if range.last_sequence <= through {
                self.refused = None;
            } else if range.first_sequence <= through {
                range.first_sequence = through.saturating_add(1);
            }
        }
        self.kept()
    }

    /// Number of records that are not acknowledged.
    #[must_use]
    pub(crate) fn kept(&self) -> u32 {
        let refused = self.refused.as_ref().map_or(0, |range| {
            range
                .last_sequence
                .saturating_sub(range.first_sequence)
                .saturating_add(1)
        });
        let whole = u32::try_from(self.whole.len()).unwrap_or(u32::MAX);
        whole.saturating_add(refused)
    }
}

/// Copies of the records in memory that a reset leaves alone.
#[cfg(feature = "link")]
impl RecordLog {
    /// The numbers of the records that are not acknowledged.
    pub(crate) fn extent(&self) -> Extent {
        Extent {
            first_left: self.first_left(),
            last_sequence: self.last_sequence,
            refused: self.refused,
        }
    }

    /// Returns a record of which there is no copy as it is, the oldest first.
    pub(crate) fn next_unkept(&mut self) -> Option<Unkept> {
        if !self.has_unkept {
            return None;
        }
        let place = self.whole.iter().find(|place| !place.is_kept);
        let Some(place) = place else {
            self.has_unkept = false;
            return None;
        };
        let slots = self.whole.iter().filter_map(|place| place.slot);
        let taken = slots.fold(0_u64, |taken, slot| taken | bit(slot));
        Some(Unkept {
            record: place.record,
            boot: place.boot,
            is_pending: place.is_pending,
            slot: u8::try_from((!taken).trailing_zeros()).unwrap_or(u8::MAX),
            outdated: place.slot,
        })
    }

    /// Notes that a record has been copied as it is.
    pub(crate) fn note_kept(&mut self, sequence: u32, slot: Slot) {
        let mut places = self.whole.iter_mut();
        if let Some(place) = places.find(|place| place.record.sequence == sequence) {
            place.slot = Some(slot);
            place.is_kept = true;
        }
    }

    /// Sets the number of the camera's start.
    pub(crate) const fn set_boot(&mut self, boot: u32) {
        self.boot = boot;
    }

    /// Takes over the numbers of a flight that a reset has ended; its whole records follow by
    /// [`Self::take_up`], in order.
    pub(crate) fn resume(&mut self, extent: &Extent) {
        self.whole.clear();
        self.refused = extent.refused;
        self.last_sequence = extent.last_sequence;
        self.has_unkept = false;
        self.has_unwritten = false;
    }

    /// Takes over the next whole record, of which there is a copy in a slot. Returns `false` if
    /// there is no room for it.
    pub(crate) fn take_up(&mut self, record: Entry, boot: u32, slot: Option<Slot>) -> bool {
        let place = Place {
            record,
            boot,
            is_pending: false,
            slot,
            is_kept: false,
            is_written: false,
        };
        // It is copied anew: a copy of a record that the reset has ended says that it is pending.
        self.has_unkept = true;
        self.has_unwritten = true;
        self.whole.push_back(place).is_ok()
    }
}

/// Copies of the records in flash.
#[cfg(feature = "store")]
impl RecordLog {
    /// Returns a finished record that the flash does not have as it is, with the number of its
    /// start; the oldest first.
    pub(crate) fn next_unwritten(&mut self) -> Option<(Entry, u32)> {
        if !self.has_unwritten {
            return None;
        }
        let mut places = self.whole.iter();
        let Some(place) = places.find(|place| !place.is_pending && !place.is_written) else {
            // A pending one tells when it is finished.
            self.has_unwritten = false;
            return None;
        };
        Some((place.record, place.boot))
    }

    /// Notes that a record is written as it is.
    pub(crate) fn note_written(&mut self, sequence: u32) {
        let mut places = self.whole.iter_mut();
        if let Some(place) = places.find(|place| place.record.sequence == sequence) {
            place.is_written = true;
        }
    }

    /// Notes a record that the flash has: it is not written again if it is the same.
    pub(crate) fn note_found(&mut self, record: &Entry, boot: u32) {
        let mut places = self.whole.iter_mut();
        if let Some(place) = places.find(|place| place.record.sequence == record.sequence) {
            place.is_written = place.record == *record && place.boot == boot;
        }
    }

    /// Number of records, finished or not, that the flash does not have as they are.
    pub(crate) fn unwritten(&self) -> u32 {
        let unwritten = self.whole.iter().filter(|place| !place.is_written).count();
        u32::try_from(unwritten).unwrap_or(u32::MAX)
    }
}

/// Returns the bit of a slot among those of all.
#[cfg(feature = "link")]
const fn bit(slot: Slot) -> u64 {
    const { assert!(SLOTS <= 64) };
    1_u64.wrapping_shl(slot as u32)
}

#[cfg(all(test, feature = "store"))]
mod sequences;
#[cfg(test)]
mod tests {
    use super::*;

    fn finish(log: &mut RecordLog, sequence: u32) {
        let record = Entry {
            sequence,
            trigger: Time::from_us(u64::from(sequence)),
            outcome: Outcome::Refused(Reason::Overlap),
            faults: Faults::NONE,
            flags: Flags::NONE,
        };
        assert!(log.finish(record));
    }

    fn number(log: &mut RecordLog) -> Numbered {
        let next = u64::from(log.last_sequence) + 1;
        log.number(Time::from_us(next))
    }

    #[test]
    fn records_come_in_order_and_wait_for_the_one_in_flight() {
        let mut log = RecordLog::new();
        for sequence in 1..=3 {
            assert_eq!(number(&mut log), Numbered::Pending(sequence));
        }
        finish(&mut log, 1);
        finish(&mut log, 3);
        assert_eq!(log.from(0).unwrap().0.sequence, 1);
        assert_eq!(log.from(2), None);
        assert_eq!(log.from(3), None, "2 is still pending");
        assert_eq!(log.acknowledge(3), 2, "only 1 is forgotten");
        finish(&mut log, 2);
        assert_eq!(log.from(0).unwrap().0.sequence, 2);
        assert_eq!(log.from(3).unwrap().0.sequence, 3);
        assert_eq!(log.from(4), None);
        assert_eq!(log.acknowledge(2), 1);
        assert_eq!(log.acknowledge(u32::MAX), 0);
        assert_eq!(log.last_sequence, 3);
    }

    #[test]
    fn every_trigger_has_a_record_when_nobody_fetches_them() {
        let mut log = RecordLog::new();
        let last = u32::try_from(CAPACITY).unwrap() + 1000;
        for sequence in 1..=last {
            match number(&mut log) {
                Numbered::Pending(found) => finish(&mut log, found),
                Numbered::Full(found) => assert_eq!(found, sequence),
            }
        }
        assert_eq!(log.kept(), last);
        let mut next = 1;
        while let Some((record, _)) = log.from(next) {
            assert_eq!(record.sequence, next);
            let is_first = next <= u32::try_from(CAPACITY).unwrap();
            assert_eq!(
                record.outcome == Outcome::Refused(Reason::RecordsFull),
                !is_first
            );
            next += 1;
        }
        assert_eq!(next, last + 1);
        // After an acknowledgement in part, the range stays without a gap, and later triggers join
        // it.
        assert_eq!(log.acknowledge(last - 10), 10);
        assert_eq!(number(&mut log), Numbered::Full(last + 1));
        assert_eq!(log.from(0).unwrap().0.sequence, last - 9);
        assert_eq!(log.acknowledge(last + 1), 0);
        assert_eq!(number(&mut log), Numbered::Pending(last + 2));
    }

    #[cfg(feature = "store")]
    #[test]
    fn record_that_the_flash_has_otherwise_or_that_is_gone_is_written_or_left_out() {
        let mut log = RecordLog::new();
        number(&mut log);
        finish(&mut log, 1);
        let (record, boot) = log.next_unwritten().unwrap();
        let other = Entry {
            outcome: Outcome::Refused(Reason::Disarmed),
            ..record
        };
        for (found, boot, is_unwritten) in [
            (&other, boot, true),
            (&record, boot + 1, true),
            (&record, boot, false),
        ] {
            log.note_found(found, boot);
            assert_eq!(log.unwritten(), u32::from(is_unwritten), "{found:?}");
        }
        // A record that has been acknowledged meanwhile.
        number(&mut log);
        finish(&mut log, 2);
        let gone = Entry {
            sequence: 1,
            ..record
        };
        assert_eq!(log.acknowledge(1), 1);
        log.note_written(1);
        log.note_found(&gone, boot);
        log.note_kept(1, 0);
        assert_eq!(log.unwritten(), 1);
        assert_eq!(log.next_unwritten().map(|(it, _)| it.sequence), Some(2));
        assert_eq!(log.next_unkept().map(|it| it.record.sequence), Some(2));
    }
}
