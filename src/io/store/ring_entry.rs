//! Bytes of an entry in a ring, and of the word with which a sector begins.

use super::layout::WORD_BYTES;
use crate::io::link::packet::CRC;

/// Words of an entry.
pub const ENTRY_WORDS: usize = 6;

/// Most bytes of an entry's contents.
pub const CONTENTS_BYTES: usize = ENTRY_BYTES - FRAME_BYTES;

/// Bytes of an entry.
pub(super) const ENTRY_BYTES: usize = ENTRY_WORDS * WORD_BYTES;

/// Bytes of an entry around its contents: format and length, number, CRC-32.
const FRAME_BYTES: usize = 2 + 4 + 4;

/// Version of the format of entries and their contents; those of another are not read.
pub(super) const RING_FORMAT: u8 = 1;

/// First bytes of a sector.
const MAGIC: [u8; 4] = *b"FMCR";

/// A word of the flash.
pub(super) type Word = [u8; WORD_BYTES];

/// A word as an erasure leaves it.
pub(super) const BLANK: Word = [0xff; WORD_BYTES];

/// An entry.
///
/// # Model
/// Version of the format (u8), length of the contents (u8), number (u32, little endian), contents,
/// zeros, CRC-32 (ISO-HDLC, little endian) of all bytes before. No first word of an entry is blank,
/// since no version is 255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RingEntry {
    bytes: [u8; ENTRY_BYTES],
}

impl RingEntry {
    /// Returns the entry of these contents, without a number; `None` if they are too long.
    pub(super) fn new(contents: &[u8]) -> Option<Self> {
        let mut bytes = [0; ENTRY_BYTES];
        let [format, length, _, _, _, _, rest @ ..] = &mut bytes;
        *format = RING_FORMAT;
        *length = u8::try_from(contents.len()).ok()?;
        if contents.len() > CONTENTS_BYTES {
            return None;
        }
        for (place, byte) in rest.iter_mut().zip(contents) {
            *place = *byte;
        }
        Some(Self { bytes })
    }

    /// Returns the same entry with a number.
    pub(super) fn numbered(mut self, number: u32) -> Self {
        let [_, _, n0, n1, n2, n3, ..] = &mut self.bytes;
        [*n0, *n1, *n2, *n3] = number.to_le_bytes();
        let [checked @ .., c0, c1, c2, c3] = &mut self.bytes;
        [*c0, *c1, *c2, *c3] = CRC.checksum(checked).to_le_bytes();
        self
    }

    /// The words, in order.
    pub(super) fn words(&self) -> &[Word] {
        self.bytes.as_chunks().0
    }

    /// Reads the words of an entry of this number; `None` if it is another, or damaged.
    pub(super) fn parse(words: &[Word; ENTRY_WORDS], number: u32) -> Option<Self> {
        let mut bytes = [0; ENTRY_BYTES];
        for (place, byte) in bytes.iter_mut().zip(words.as_flattened()) {
            *place = *byte;
        }
        let entry = Self { bytes };
        let (checked, crc) = bytes.split_last_chunk()?;
        let [format, length, n0, n1, n2, n3, ..] = bytes;
        let is_whole = format == RING_FORMAT
            && usize::from(length) <= CONTENTS_BYTES
            && u32::from_le_bytes([n0, n1, n2, n3]) == number
            && u32::from_le_bytes(*crc) == CRC.checksum(checked);
        is_whole.then_some(entry)
    }

    /// The contents.
    #[must_use]
    pub fn contents(&self) -> &[u8] {
        let [_, length, _, _, _, _, rest @ ..] = &self.bytes;
        rest.get(..usize::from(*length)).unwrap_or_default()
    }
}

/// Returns the first word of a sector that has been erased to its end for the so manieth time.
///
/// # Model
/// Little endian: `FMCR`, version of the format (u32), number of the erasure (u32), 16 zeros,
/// CRC-32 of these 28 bytes.
pub(super) fn sector_word(generation: u32) -> Word {
    let mut word = [0; WORD_BYTES];
    let [g0, g1, g2, g3] = generation.to_le_bytes();
    let [m0, m1, m2, m3] = MAGIC;
    let head = [m0, m1, m2, m3, RING_FORMAT, 0, 0, 0, g0, g1, g2, g3];
    for (place, byte) in word.iter_mut().zip(head) {
        *place = byte;
    }
    let [checked @ .., c0, c1, c2, c3] = &mut word;
    [*c0, *c1, *c2, *c3] = CRC.checksum(checked).to_le_bytes();
    word
}

/// Returns the number of the erasure that the first word of a sector tells; `None` if it is none.
pub(super) fn generation_of(word: &Word) -> Option<u32> {
    let [_, _, _, _, _, _, _, _, g0, g1, g2, g3, ..] = *word;
    let generation = u32::from_le_bytes([g0, g1, g2, g3]);
    (*word == sector_word(generation)).then_some(generation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entry_is_read_as_it_was_written_under_its_number_alone() {
        let contents = [0x5a; CONTENTS_BYTES];
        for length in [0, 1, CONTENTS_BYTES] {
            let entry = RingEntry::new(&contents[..length]).unwrap().numbered(77);
            let words = *entry.words().as_array().unwrap();
            assert_eq!(RingEntry::parse(&words, 77), Some(entry));
            assert_eq!(entry.contents(), &contents[..length]);
            assert_eq!(RingEntry::parse(&words, 78), None);
            for bit in 0..8 * ENTRY_BYTES {
                let mut damaged = words;
                damaged.as_flattened_mut()[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(RingEntry::parse(&damaged, 77), None, "bit {bit}");
            }
        }
        assert_eq!(RingEntry::new(&[0; CONTENTS_BYTES + 1]), None);
    }

    #[test]
    fn sector_word_tells_its_erasure_and_no_other_word_does() {
        for generation in [0, 1, u32::MAX] {
            let word = sector_word(generation);
            assert_eq!(generation_of(&word), Some(generation));
            for bit in 0..8 * WORD_BYTES {
                let mut damaged = word;
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(generation_of(&damaged), None, "bit {bit}");
            }
        }
        assert_eq!(generation_of(&BLANK), None);
        assert_eq!(generation_of(&[0; WORD_BYTES]), None);
    }
}
