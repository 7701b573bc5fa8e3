//! Commit word: the first of a slot, and the last that is written of a record.

use super::fault::SlotFault;
use super::layout::{FORMAT_VERSION, MAX_BODY_WORDS, OLDEST_FORMAT};
use super::slot::{BLANK, Word};
use crate::io::link::packet::CRC;

/// First bytes of the word.
const MAGIC: [u8; 4] = *b"FMCS";

/// Contents of a commit word.
///
/// # Model
/// Little endian: `FMCS`, version of the format (u16), words of the body (u16), number of the store
/// (u32), CRC-32 (ISO-HDLC) of the body (u32), 12 bytes of zeros, CRC-32 of the 28 bytes before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Commit {
    /// Number of the store: one more than that of the store before; after the largest comes 0.
    pub(super) sequence: u32,
    /// Words of the body.
    pub(super) words: u16,
    /// CRC-32 of all words of the body.
    pub(super) crc: u32,
}

impl Commit {
    /// Returns the word.
    pub(super) fn to_word(self) -> Word {
        let [m0, m1, m2, m3] = MAGIC;
        let [f0, f1] = FORMAT_VERSION.to_le_bytes();
        let [w0, w1] = self.words.to_le_bytes();
        let [s0, s1, s2, s3] = self.sequence.to_le_bytes();
        let [c0, c1, c2, c3] = self.crc.to_le_bytes();
        let checked = [
            m0, m1, m2, m3, f0, f1, w0, w1, s0, s1, s2, s3, c0, c1, c2, c3, 0, 0, 0, 0, 0, 0, 0, 0,
            0, 0, 0, 0,
        ];
        let mut word = [0; _];
        let crc = CRC.checksum(&checked).to_le_bytes();
        for (place, byte) in word.iter_mut().zip(checked.into_iter().chain(crc)) {
            *place = byte;
        }
        word
    }

    /// Reads a word.
    pub(super) fn parse(word: &Word) -> Result<Self, SlotFault> {
        if *word == BLANK {
            return Err(SlotFault::Blank);
        }
        let [
            m0,
            m1,
            m2,
            m3,
            f0,
            f1,
            w0,
            w1,
            s0,
            s1,
            s2,
            s3,
            c0,
            c1,
            c2,
            c3,
            ..,
        ] = *word;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(SlotFault::NoRecord);
        }
        let [checked @ .., e0, e1, e2, e3] = word;
        let stored = u32::from_le_bytes([*e0, *e1, *e2, *e3]);
        let computed = CRC.checksum(checked);
        if stored != computed {
            return Err(SlotFault::CommitCrc { stored, computed });
        }
        let version = u16::from_le_bytes([f0, f1]);
        if !(OLDEST_FORMAT..=FORMAT_VERSION).contains(&version) {
            return Err(SlotFault::Format(version));
        }
        let words = u16::from_le_bytes([w0, w1]);
        if !(1..=MAX_BODY_WORDS).contains(&words) {
            return Err(SlotFault::Length(words));
        }
        Ok(Self {
            sequence: u32::from_le_bytes([s0, s1, s2, s3]),
            words,
            crc: u32::from_le_bytes([c0, c1, c2, c3]),
        })
    }

    /// Returns `true` if this record was stored after another.
    pub(super) const fn is_newer_than(&self, other: &Self) -> bool {
        // Numbers count on from the largest to 0, and two slots are one apart.
        self.sequence.wrapping_sub(other.sequence).cast_signed() > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn word_is_read_as_it_was_written_and_numbers_count_on() {
        let commit = Commit {
            sequence: u32::MAX,
            words: 14,
            crc: 0xdead_beef,
        };
        assert_eq!(Commit::parse(&commit.to_word()), Ok(commit));
        let next = Commit {
            sequence: 0,
            ..commit
        };
        assert!(next.is_newer_than(&commit) && !commit.is_newer_than(&next));
        assert!(!commit.is_newer_than(&commit));
    }

    #[test]
    fn record_of_another_format_and_of_no_length_is_named() {
        let with = |version: u16, words: u16| {
            let mut word = Commit {
                sequence: 1,
                words,
                crc: 0,
            }
            .to_word();
            word[4..6].copy_from_slice(&version.to_le_bytes());
            let crc = CRC.checksum(&word[..28]).to_le_bytes();
            word[28..].copy_from_slice(&crc);
            Commit::parse(&word)
        };
        for other in [OLDEST_FORMAT - 1, FORMAT_VERSION + 1] {
            assert_eq!(with(other, 14), Err(SlotFault::Format(other)));
        }
        for read in OLDEST_FORMAT..=FORMAT_VERSION {
            assert_eq!(with(read, 14).map(|commit| commit.words), Ok(14));
        }
        assert_eq!(with(FORMAT_VERSION, 0), Err(SlotFault::Length(0)));
        let long = MAX_BODY_WORDS + 1;
        assert_eq!(with(FORMAT_VERSION, long), Err(SlotFault::Length(long)));
        assert_eq!(Commit::parse(&[0; 32]), Err(SlotFault::NoRecord));
        assert_eq!(Commit::parse(&BLANK), Err(SlotFault::Blank));
    }
}
