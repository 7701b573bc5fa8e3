//! All short sequences of triggers, records, acknowledgements and copies, against a slow log.

#![allow(
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::struct_excessive_bools,
    clippy::unwrap_used,
    reason = "tests"
)]

use std::vec::Vec;

use super::*;

/// Number of steps in a sequence.
const LENGTH: usize = 5;

/// A step of the camera, or of the PC.
#[derive(Debug, Clone, Copy)]
enum Step {
    Trigger,
    FinishOldest,
    FinishNewest,
    AcknowledgeOldest,
    AcknowledgeAll,
    Restart,
    Keep,
    Write,
}

const STEPS: [Step; 8] = [
    Step::Trigger,
    Step::FinishOldest,
    Step::FinishNewest,
    Step::AcknowledgeOldest,
    Step::AcknowledgeAll,
    Step::Restart,
    Step::Keep,
    Step::Write,
];

/// A log that has a record of every trigger.
#[derive(Debug, Clone, Default)]
struct Slow {
    records: Vec<SlowRecord>,
    last: u32,
    boot: u32,
    /// Time of the first trigger that was refused for want of room, since there was room.
    range_first: Option<Time>,
    /// Slots of the copies in memory, by the sequence that is in them.
    slots: Vec<(Slot, u32)>,
}

#[derive(Debug, Clone)]
struct SlowRecord {
    entry: Entry,
    boot: u32,
    is_pending: bool,
    /// Refused for want of room: no place of its own.
    is_range: bool,
    is_kept: bool,
    is_written: bool,
}

fn finished(sequence: u32) -> Entry {
    Entry {
        outcome: Outcome::Refused(Reason::Overlap),
        ..Entry::without_room(sequence, trigger_time(sequence))
    }
}

fn trigger_time(sequence: u32) -> Time {
    Time::from_us(1000 * u64::from(sequence))
}

impl Slow {
    fn number(&mut self) -> Numbered {
        self.last += 1;
        let trigger = trigger_time(self.last);
        let has_range = self.records.iter().any(|record| record.is_range);
        let is_range = has_range || self.records.len() == CAPACITY;
        if is_range && !has_range {
            self.range_first = Some(trigger);
        }
        // Of the range only the times of the first and the last, and the start of the last, are
        // kept.
        for record in self.records.iter_mut().filter(|record| record.is_range) {
            record.entry.trigger = self.range_first.unwrap();
            record.boot = self.boot;
        }
        self.records.push(SlowRecord {
            entry: Entry::without_room(self.last, trigger),
            boot: self.boot,
            is_pending: !is_range,
            is_range,
            is_kept: false,
            is_written: false,
        });
        if is_range {
            Numbered::Full(self.last)
        } else {
            Numbered::Pending(self.last)
        }
    }

    fn finish(&mut self, sequence: u32) {
        let record = self.record_mut(sequence);
        record.entry = finished(sequence);
        record.is_pending = false;
        record.is_kept = false;
        record.is_written = false;
    }

    fn record_mut(&mut self, sequence: u32) -> &mut SlowRecord {
        let mut records = self.records.iter_mut();
        records
            .find(|record| record.entry.sequence == sequence)
            .unwrap()
    }

    fn acknowledge(&mut self, through: u32) -> u32 {
        let stays = |record: &SlowRecord| record.is_pending || record.entry.sequence > through;
        let first = self.records.iter().position(stays);
        self.records.drain(..first.unwrap_or(self.records.len()));
        u32::try_from(self.records.len()).unwrap()
    }

    fn pending(&self) -> impl DoubleEndedIterator<Item = u32> {
        let pending = self.records.iter().filter(|record| record.is_pending);
        pending.map(|record| record.entry.sequence)
    }

    fn whole(&self) -> impl Iterator<Item = &SlowRecord> {
        self.records.iter().filter(|record| !record.is_range)
    }

    fn from(&self, sequence: u32) -> Option<(Entry, u32)> {
        let is_meant = |record: &SlowRecord| record.entry.sequence >= sequence;
        let index = self.records.iter().position(is_meant)?;
        let is_behind_a_pending_one = self.records[..=index].iter().any(|it| it.is_pending);
        let record = &self.records[index];
        (!is_behind_a_pending_one).then_some((record.entry, record.boot))
    }
}

fn compare(log: &RecordLog, slow: &Slow) {
    assert_eq!(log.last_sequence(), slow.last);
    assert_eq!(log.kept() as usize, slow.records.len());
    let first = slow.records.first().map(|record| record.entry.sequence);
    assert_eq!(log.first_left(), first.unwrap_or(slow.last + 1));
    for sequence in 0..=slow.last + 1 {
        assert_eq!(log.from(sequence), slow.from(sequence), "{sequence}");
    }
    let mut log = log.clone();
    let unkept = slow.whole().find(|record| !record.is_kept);
    let found = log.next_unkept();
    assert_eq!(
        found.map(|it| (it.record, it.boot, it.is_pending)),
        unkept.map(|it| (it.entry, it.boot, it.is_pending))
    );
    if let Some(found) = found {
        assert!(usize::from(found.slot) < SLOTS);
        assert!(slow.slots.iter().all(|(slot, _)| *slot != found.slot));
    }
    let unwritten = slow.whole().find(|it| !it.is_pending && !it.is_written);
    assert_eq!(
        log.next_unwritten(),
        unwritten.map(|it| (it.entry, it.boot))
    );
    let unwritten = slow.whole().filter(|it| !it.is_written).count();
    assert_eq!(log.unwritten() as usize, unwritten);
}

/// Takes a step in both; `false` if there is nothing to do.
fn take(step: Step, log: &mut RecordLog, slow: &mut Slow) -> bool {
    match step {
        Step::Trigger => {
            assert_eq!(log.number(trigger_time(slow.last + 1)), slow.number());
        }
        Step::FinishOldest | Step::FinishNewest => {
            let is_oldest = matches!(step, Step::FinishOldest);
            let [oldest, newest] = [slow.pending().next(), slow.pending().next_back()];
            let Some(sequence) = (if is_oldest { oldest } else { newest }) else {
                assert!(!log.finish(finished(slow.last)));
                return false;
            };
            assert!(log.finish(finished(sequence)));
            slow.finish(sequence);
        }
        Step::AcknowledgeOldest => {
            let first = slow.records.first().map(|record| record.entry.sequence);
            let through = first.unwrap_or(slow.last);
            assert_eq!(log.acknowledge(through), slow.acknowledge(through));
        }
        Step::AcknowledgeAll => {
            assert_eq!(log.acknowledge(slow.last), slow.acknowledge(slow.last));
        }
        Step::Restart => {
            slow.boot += 1;
            log.set_boot(slow.boot);
        }
        Step::Keep => {
            let Some(unkept) = log.next_unkept() else {
                return false;
            };
            log.note_kept(unkept.record.sequence, unkept.slot);
            slow.record_mut(unkept.record.sequence).is_kept = true;
            slow.slots
                .retain(|(_, sequence)| *sequence != unkept.record.sequence);
            slow.slots.push((unkept.slot, unkept.record.sequence));
        }
        Step::Write => {
            let Some((record, _)) = log.next_unwritten() else {
                return false;
            };
            log.note_written(record.sequence);
            slow.record_mut(record.sequence).is_written = true;
        }
    }
    // Copies of records that the PC has are not wanted.
    let whole: Vec<u32> = slow.whole().map(|record| record.entry.sequence).collect();
    slow.slots.retain(|(_, sequence)| whole.contains(sequence));
    true
}

/// Tries every sequence of so many steps from here; returns how many there are.
fn try_all(log: &RecordLog, slow: &Slow, left: usize) -> u32 {
    compare(log, slow);
    if left == 0 {
        return 1;
    }
    let steps = STEPS.into_iter().map(|step| {
        let (mut log, mut slow) = (log.clone(), slow.clone());
        if take(step, &mut log, &mut slow) {
            try_all(&log, &slow, left - 1)
        } else {
            compare(&log, &slow);
            0
        }
    });
    steps.sum()
}

/// A log, and its slow one, of so many records, of which those behind `finished` are pending.
fn after(triggers: usize, finished: usize) -> (RecordLog, Slow) {
    let mut log = RecordLog::new();
    let mut slow = Slow {
        boot: FIRST_BOOT,
        ..Slow::default()
    };
    for _ in 0..triggers {
        assert!(take(Step::Trigger, &mut log, &mut slow));
    }
    for _ in 0..finished {
        assert!(take(Step::FinishOldest, &mut log, &mut slow));
    }
    (log, slow)
}

#[test]
fn every_short_sequence_of_triggers_records_and_acknowledgements_is_kept_as_by_a_slow_log() {
    let mut sequences = Vec::new();
    for (triggers, finished) in [
        (0, 0),
        (CAPACITY - 1, CAPACITY - 2),
        (CAPACITY + 2, CAPACITY),
    ] {
        let (log, slow) = after(triggers, finished);
        sequences.push(try_all(&log, &slow, LENGTH));
    }
    // docs/models.md has their sum.
    assert_eq!(sequences, [3614, 19_796, 5839]);
}
