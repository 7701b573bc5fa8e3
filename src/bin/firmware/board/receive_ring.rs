//! Bytes on their way from the receive interrupt to the main loop.

use core::sync::atomic::{AtomicU8, AtomicU32, AtomicUsize, Ordering};

use fmc_camera::io::link::LONGEST_FRAME;

/// Bytes that wait at most: two of the longest frames and more. The counters wrap, hence a power of two.
const CAPACITY: usize = (2 * LONGEST_FRAME).next_power_of_two();

/// Ring with one writer, the interrupt, and one reader, the main loop.
pub(super) struct ReceiveRing {
    bytes: [AtomicU8; CAPACITY],
    /// Bytes written since the start, wrapping.
    written: AtomicUsize,
    /// Bytes read since the start, wrapping.
    read: AtomicUsize,
    lost: AtomicU32,
}

impl ReceiveRing {
    pub(super) const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; CAPACITY],
            written: AtomicUsize::new(0),
            read: AtomicUsize::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Appends a byte; where the ring is full the byte is lost and counted.
    pub(super) fn push(&self, byte: u8) {
        let written = self.written.load(Ordering::Relaxed);
        match self.bytes.get(written % CAPACITY) {
            Some(place) if self.has_room() => {
                place.store(byte, Ordering::Relaxed);
                self.written
                    .store(written.wrapping_add(1), Ordering::Release);
            }
            _ => self.lose(1),
        }
    }

    /// Takes the oldest byte.
    pub(super) fn pop(&self) -> Option<u8> {
        let read = self.read.load(Ordering::Relaxed);
        if read == self.written.load(Ordering::Acquire) {
            return None;
        }
        let byte = self.bytes.get(read % CAPACITY)?.load(Ordering::Relaxed);
        self.read.store(read.wrapping_add(1), Ordering::Release);
        Some(byte)
    }

    /// Whether another byte can be kept.
    pub(super) fn has_room(&self) -> bool {
        let written = self.written.load(Ordering::Relaxed);
        written.wrapping_sub(self.read.load(Ordering::Acquire)) < CAPACITY
    }

    /// Whether no byte waits.
    pub(super) fn is_empty(&self) -> bool {
        self.read.load(Ordering::Relaxed) == self.written.load(Ordering::Acquire)
    }

    /// Counts bytes as lost.
    pub(super) fn lose(&self, count: u32) {
        self.lost.fetch_add(count, Ordering::Relaxed);
    }

    /// Bytes lost since this was asked last.
    pub(super) fn take_lost(&self) -> u32 {
        self.lost.swap(0, Ordering::Relaxed)
    }
}
