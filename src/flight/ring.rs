//! Rings of bytes and time stamps between an interrupt and the main loop.

use core::fmt;
use core::sync::atomic::{AtomicU8, AtomicU32, AtomicUsize, Ordering};

/// An item of a ring: a byte of a serial line, or the stamp of an edge.
pub trait Item: Copy + sealed::Sealed {
    /// Storage of one item.
    type Place: fmt::Debug;

    /// A place without an item.
    #[doc(hidden)]
    const EMPTY: Self::Place;

    /// Returns the item in a place.
    #[doc(hidden)]
    fn load(place: &Self::Place) -> Self;

    /// Puts the item into a place.
    #[doc(hidden)]
    fn store(self, place: &Self::Place);
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for u32 {}
}

impl Item for u8 {
    type Place = AtomicU8;
    const EMPTY: AtomicU8 = AtomicU8::new(0);

    #[inline]
    fn load(place: &AtomicU8) -> Self {
        place.load(Ordering::Relaxed)
    }

    #[inline]
    fn store(self, place: &AtomicU8) {
        place.store(self, Ordering::Relaxed);
    }
}

impl Item for u32 {
    type Place = AtomicU32;
    const EMPTY: AtomicU32 = AtomicU32::new(0);

    #[inline]
    fn load(place: &AtomicU32) -> Self {
        place.load(Ordering::Relaxed)
    }

    #[inline]
    fn store(self, place: &AtomicU32) {
        place.store(self, Ordering::Relaxed);
    }
}

/// A ring with one writer, the interrupt, and one reader, the main loop; `PLACES` is a power of
/// two.
///
/// Every line has a separate ring, so that a line that bounces keeps out no item of another.
///
/// ```
/// use fmc_camera::flight::ring::Ring;
///
/// static RECEIVED: Ring<u8, 4> = Ring::new();
/// RECEIVED.push(0x55);
/// assert_eq!((RECEIVED.pop(), RECEIVED.pop()), (Some(0x55), None));
/// ```
#[derive(Debug)]
pub struct Ring<T: Item, const PLACES: usize> {
    places: [T::Place; PLACES],
    /// Items written since the start, wrapping.
    written: AtomicUsize,
    /// Items read since the start, wrapping.
    read: AtomicUsize,
    lost: AtomicU32,
}

impl<T: Item, const PLACES: usize> Ring<T, PLACES> {
    /// An empty ring.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(PLACES.is_power_of_two(), "the counters wrap") };
        Self {
            places: [const { T::EMPTY }; PLACES],
            written: AtomicUsize::new(0),
            read: AtomicUsize::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Keeps an item; without room it is lost and counted.
    #[inline]
    pub fn push(&self, item: T) {
        let written = self.written.load(Ordering::Relaxed);
        match self.places.get(written % PLACES) {
            Some(place) if self.has_room() => {
                item.store(place);
                self.written
                    .store(written.wrapping_add(1), Ordering::Release);
            }
            _ => self.lose(1),
        }
    }

    /// Takes the oldest item.
    #[inline]
    pub fn pop(&self) -> Option<T> {
        let read = self.read.load(Ordering::Relaxed);
        if read == self.written.load(Ordering::Acquire) {
            return None;
        }
        let item = T::load(self.places.get(read % PLACES)?);
        self.read.store(read.wrapping_add(1), Ordering::Release);
        Some(item)
    }

    /// Returns `true` if another item can be kept.
    #[inline]
    pub fn has_room(&self) -> bool {
        let written = self.written.load(Ordering::Relaxed);
        written.wrapping_sub(self.read.load(Ordering::Acquire)) < PLACES
    }

    /// Returns `true` if no item waits.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.read.load(Ordering::Relaxed) == self.written.load(Ordering::Acquire)
    }

    /// Counts items as lost, as the device reports them.
    pub fn lose(&self, items: u32) {
        self.lost.fetch_add(items, Ordering::Relaxed);
    }

    /// Returns the number of items lost since the last call.
    pub fn take_lost(&self) -> u32 {
        self.lost.swap(0, Ordering::Relaxed)
    }
}

impl<const PLACES: usize> Ring<u32, PLACES> {
    /// Takes the stamp that the interrupt of a capture input found in its register.
    /// `was_overwritten` is `true` if an earlier edge was overwritten there, which is lost and
    /// counted.
    ///
    /// Returns `true` if the line may interrupt again. A line that has filled its ring oscillates,
    /// and must not use up the processor's time: it is to be enabled again once the ring has been
    /// read.
    #[must_use]
    pub fn capture(&self, stamp: Option<u32>, was_overwritten: bool) -> bool {
        if was_overwritten {
            self.lose(1);
        }
        if let Some(stamp) = stamp {
            self.push(stamp);
        }
        self.has_room()
    }
}

impl<T: Item, const PLACES: usize> Default for Ring<T, PLACES> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::Ring;

    #[test]
    fn items_come_out_as_they_went_in_and_those_without_room_are_counted() {
        let stamps = Ring::<u32, 4>::new();
        let bytes = Ring::<u8, 4>::new();
        for round in 0..1000 {
            for number in 0..6 {
                assert_eq!(stamps.has_room(), number < 4);
                stamps.push(10 * round + number);
                bytes.push((10 * round + number).to_le_bytes()[0]);
            }
            for number in 0..4 {
                let stamp = 10 * round + number;
                assert!(!stamps.is_empty() && !bytes.is_empty());
                assert_eq!(stamps.pop(), Some(stamp));
                assert_eq!(bytes.pop(), Some(stamp.to_le_bytes()[0]));
            }
            assert!(stamps.is_empty() && bytes.is_empty());
            assert_eq!((stamps.pop(), bytes.pop()), (None, None));
            for lost in [stamps.take_lost(), bytes.take_lost()] {
                assert_eq!(lost, 2);
            }
            assert_eq!(stamps.take_lost(), 0);
        }
    }

    #[test]
    fn line_that_oscillates_is_listened_to_until_its_ring_is_full_and_again_once_it_is_read() {
        let edges = Ring::<u32, 4>::default();
        for stamp in 0..3 {
            assert!(edges.capture(Some(stamp), false));
        }
        assert!(!edges.capture(Some(3), false));
        // The interrupt of another line finds the stamp that has come meanwhile.
        assert!(!edges.capture(Some(9), true));
        assert_eq!(edges.take_lost(), 2, "overwritten, and without room");
        assert!((0..4).all(|stamp| edges.pop() == Some(stamp)));
        assert!(edges.capture(None, false));
        // The overwritten edge is lost, the one in the register is not.
        assert!(edges.capture(Some(20), true));
        assert_eq!((edges.pop(), edges.take_lost()), (Some(20), 1));
    }
}
