//! Records that the next crossing of the index mark is to confirm.

use super::in_doubt::InDoubt;

/// Records since the last crossings of the index mark, along the FMC axis and against it.
///
/// # Model
/// A crossing tells that no counts were lost before it. Counts that are lost after it, and before
/// the exposure ends, show at the next one. A record waits for that; if it does not come, because
/// the mark is not seen any more or the force is taken off, what it would have shown may be in the
/// record: the record is left in doubt.
///
/// A record also waits for a pair of crossings, along the axis and against it, which shows if the
/// play has grown or the encoder counts another length
/// ([`PlayWatch`](super::play_watch::PlayWatch)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unconfirmed {
    /// The last record that was compared with the mark, until a crossing confirms its counts.
    counts: Option<u32>,
    /// The first record since the last pair of crossings.
    pair_from: Option<u32>,
    /// The last record.
    last: u32,
    /// σ of the counts that may be lost unseen in one record, mm.
    lost_mm: f32,
}

/// A record, and the crossings that it waits for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Waiting {
    pub(crate) sequence: u32,
    /// It has been compared with the mark.
    pub(crate) is_referenced: bool,
    /// The camera has pairs of crossings, which it waits for.
    pub(crate) awaits_pair: bool,
    /// σ of the counts that may be lost unseen in it, mm.
    pub(crate) lost_mm: f32,
}

impl Unconfirmed {
    /// Returns no record.
    pub(crate) const fn new() -> Self {
        Self {
            counts: None,
            pair_from: None,
            last: 0,
            lost_mm: 0.0,
        }
    }

    /// Notes a record.
    pub(crate) fn wait(&mut self, record: &Waiting) {
        if record.is_referenced {
            self.counts = Some(record.sequence);
        }
        if record.awaits_pair {
            self.pair_from.get_or_insert(record.sequence);
        }
        self.last = record.sequence;
        self.lost_mm = record.lost_mm;
    }

    /// Notes that a crossing has told of the counts.
    pub(crate) const fn confirm_counts(&mut self) {
        self.counts = None;
    }

    /// Notes a pair of crossings. Returns the first record since another one.
    pub(crate) const fn confirm_pair(&mut self) -> Option<u32> {
        self.pair_from.take()
    }

    /// Returns the record whose counts no crossing will confirm any more.
    pub(crate) fn take_counts(&mut self) -> Option<InDoubt> {
        let sequence = self.counts.take()?;
        Some(InDoubt::between([sequence; 2], self.lost_mm, false))
    }

    /// Returns the last record, if no pair of crossings has come since.
    pub(crate) fn take_pair(&mut self) -> Option<InDoubt> {
        self.pair_from.take()?;
        Some(InDoubt::between([self.last; 2], self.lost_mm, false))
    }

    /// Returns the last record, if no crossing or no pair of crossings has come since.
    pub(crate) fn take(&mut self) -> Option<InDoubt> {
        let pair = self.take_pair();
        match (self.take_counts(), pair) {
            (Some(counts), Some(pair)) => Some(counts.with(pair)),
            (counts, pair) => counts.or(pair),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOST_MM: f32 = 0.009;

    fn record(sequence: u32, is_referenced: bool, awaits_pair: bool) -> Waiting {
        Waiting {
            sequence,
            is_referenced,
            awaits_pair,
            lost_mm: LOST_MM,
        }
    }

    fn of(range: [u32; 2]) -> InDoubt {
        InDoubt::between(range, LOST_MM, false)
    }

    #[test]
    fn record_waits_until_a_crossing_tells_of_its_counts_or_is_in_doubt_once() {
        let mut unconfirmed = Unconfirmed::new();
        assert_eq!(unconfirmed.take(), None);
        unconfirmed.wait(&record(3, true, false));
        unconfirmed.confirm_counts();
        assert_eq!(unconfirmed.take(), None);
        unconfirmed.wait(&record(4, true, false));
        // The next has no crossing, and says so itself.
        unconfirmed.wait(&record(5, false, false));
        assert_eq!(unconfirmed.take_counts(), Some(of([4, 4])));
        assert_eq!(unconfirmed.take(), None);
    }

    #[test]
    fn record_waits_for_a_pair_of_crossings_apart_from_its_counts() {
        let mut unconfirmed = Unconfirmed::new();
        unconfirmed.wait(&record(3, true, true));
        unconfirmed.confirm_counts();
        unconfirmed.wait(&record(4, true, true));
        unconfirmed.confirm_counts();
        // All since are asked about where a pair differs, the last where none comes.
        assert_eq!(unconfirmed.take_pair(), Some(of([4, 4])));
        unconfirmed.wait(&record(5, true, true));
        unconfirmed.wait(&record(6, true, true));
        assert_eq!(unconfirmed.confirm_pair(), Some(5));
        assert_eq!(unconfirmed.confirm_pair(), None);
        unconfirmed.wait(&record(7, true, true));
        unconfirmed.wait(&record(8, false, true));
        assert_eq!(unconfirmed.take(), Some(of([7, 8])));
    }
}
