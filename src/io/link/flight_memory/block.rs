//! Bytes in memory with their number and their CRC-32.

use core::sync::atomic::AtomicU32;

use super::words::{load, settle, store};
use crate::io::link::packet::CRC;

/// Words in front of the bytes: their check and their number.
const HEAD_WORDS: usize = 2;
/// Bytes of a word.
const WORD: usize = size_of::<u32>();

/// Version of all that is kept; a firmware with another does not read it.
const LAYOUT: u32 = 3;

/// Added to a CRC-32, so that memory full of zeros is no block.
const SEAL: u32 = 0x0f11_6847 ^ LAYOUT;

/// Returns the CRC-32 of bytes.
pub(super) fn sum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Place of bytes in the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Block {
    start: usize,
    /// Most bytes, in whole words.
    capacity: usize,
}

impl Block {
    /// The block behind another, or the first.
    pub(super) const fn after(before: Option<&Self>, capacity: usize) -> Self {
        assert!(capacity.is_multiple_of(WORD));
        let start = match before {
            Some(before) => before.start + before.words(),
            None => 0,
        };
        Self { start, capacity }
    }

    /// The block so many places behind this one, in a row of the same length.
    pub(super) const fn nth(&self, index: usize) -> Self {
        Self {
            start: self.start + index * self.words(),
            capacity: self.capacity,
        }
    }

    /// Number of its first word.
    pub(super) const fn start(&self) -> usize {
        self.start
    }

    const fn words(&self) -> usize {
        HEAD_WORDS + self.capacity / WORD
    }

    /// Check of bytes and their number.
    fn check(bytes: &[u8]) -> u32 {
        let mut digest = CRC.digest();
        digest.update(&bytes.len().to_le_bytes());
        digest.update(bytes);
        digest.finalize() ^ SEAL
    }

    /// Writes bytes that fit, and returns their CRC-32. Until the last word is written there is no
    /// block.
    pub(super) fn write(&self, memory: &[AtomicU32], bytes: &[u8]) -> u32 {
        let check = Self::check(bytes);
        self.take_away(memory);
        store(
            memory,
            self.start + 1,
            u32::try_from(bytes.len()).unwrap_or(0),
        );
        for (at, piece) in (self.start + HEAD_WORDS..).zip(bytes.chunks(WORD)) {
            let mut word = [0; WORD];
            for (place, byte) in word.iter_mut().zip(piece) {
                *place = *byte;
            }
            store(memory, at, u32::from_le_bytes(word));
        }
        settle();
        store(memory, self.start, check);
        settle();
        sum(bytes)
    }

    /// Ends the block: its bytes are read no more.
    pub(super) fn take_away(&self, memory: &[AtomicU32]) {
        // No change of the check: two words that are damaged might fit each other.
        store(memory, self.start, 0);
        store(memory, self.start + 1, u32::MAX);
        settle();
    }

    /// Reads the bytes into a buffer; `None` if there are none, or they are damaged.
    pub(super) fn read<'a>(&self, memory: &[AtomicU32], buffer: &'a mut [u8]) -> Option<&'a [u8]> {
        let length = usize::try_from(load(memory, self.start + 1)).ok()?;
        if length > self.capacity {
            return None;
        }
        let bytes = buffer.get_mut(..length)?;
        for (at, piece) in (self.start + HEAD_WORDS..).zip(bytes.chunks_mut(WORD)) {
            let word = load(memory, at).to_le_bytes();
            for (place, byte) in piece.iter_mut().zip(word) {
                *place = byte;
            }
        }
        (load(memory, self.start) == Self::check(bytes)).then_some(bytes)
    }
}
