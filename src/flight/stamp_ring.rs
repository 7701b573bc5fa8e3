//! Time stamps on their way from an interrupt to the control loop.

use core::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

/// A ring of the stamps of one line, with one writer, the interrupt, and one reader, the control loop; `PLACES` is a power
/// of two.
///
/// A line has a ring of its own, so that one that bounces keeps out no other's edges.
#[derive(Debug)]
pub struct StampRing<const PLACES: usize> {
    stamps: [AtomicU32; PLACES],
    /// Stamps written since the start, wrapping.
    written: AtomicUsize,
    /// Stamps read since the start, wrapping.
    read: AtomicUsize,
    lost: AtomicU32,
}

impl<const PLACES: usize> StampRing<PLACES> {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(PLACES.is_power_of_two(), "the counters wrap") };
        Self {
            stamps: [const { AtomicU32::new(0) }; PLACES],
            written: AtomicUsize::new(0),
            read: AtomicUsize::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Keeps a stamp; where there is no room it is lost and counted.
    pub fn push(&self, stamp: u32) {
        let written = self.written.load(Ordering::Relaxed);
        match self.stamps.get(written % PLACES) {
            Some(place) if self.has_room() => {
                place.store(stamp, Ordering::Relaxed);
                self.written
                    .store(written.wrapping_add(1), Ordering::Release);
            }
            _ => self.lose(1),
        }
    }

    /// Takes the oldest stamp.
    pub fn pop(&self) -> Option<u32> {
        let read = self.read.load(Ordering::Relaxed);
        if read == self.written.load(Ordering::Acquire) {
            return None;
        }
        let stamp = self.stamps.get(read % PLACES)?.load(Ordering::Relaxed);
        self.read.store(read.wrapping_add(1), Ordering::Release);
        Some(stamp)
    }

    /// Whether another stamp can be kept.
    pub fn has_room(&self) -> bool {
        let written = self.written.load(Ordering::Relaxed);
        written.wrapping_sub(self.read.load(Ordering::Acquire)) < PLACES
    }

    /// Counts edges as lost, where the timer says so.
    pub fn lose(&self, edges: u32) {
        self.lost.fetch_add(edges, Ordering::Relaxed);
    }

    /// Edges lost since this was asked last.
    pub fn take_lost(&self) -> u32 {
        self.lost.swap(0, Ordering::Relaxed)
    }
}

impl<const PLACES: usize> Default for StampRing<PLACES> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::StampRing;

    #[test]
    fn stamps_come_out_as_they_went_in_and_those_without_room_are_counted() {
        let ring = StampRing::<4>::new();
        for round in 0..1000 {
            for stamp in 0..6 {
                assert_eq!(ring.has_room(), stamp < 4);
                ring.push(10 * round + stamp);
            }
            for stamp in 0..4 {
                assert_eq!(ring.pop(), Some(10 * round + stamp));
            }
            assert_eq!(
                (ring.pop(), ring.take_lost(), ring.take_lost()),
                (None, 2, 0)
            );
        }
    }
}
