//! Words of a slot, each read and written by itself.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

use super::layout::{SEAL_WORDS, WORD_BYTES};

/// A word.
pub(super) type Word = [u8; WORD_BYTES];

/// A word as an erasure leaves it.
pub(super) const BLANK: Word = [0xff; WORD_BYTES];

/// Index of the first word of a body.
pub(super) const BODY: u16 = 1 + SEAL_WORDS;

/// Seal.
const SEAL: Word = *b"fmc-camera: record is committed\n";

/// A slot of a flash.
pub(super) struct Slot<'a, F> {
    pub(super) flash: &'a mut F,
    /// Offset of the slot in the flash, bytes.
    pub(super) offset: u32,
}

impl<F: ReadNorFlash> Slot<'_, F> {
    /// Reads a word; `None` if it cannot be read.
    pub(super) fn read(&mut self, index: u16) -> Option<Word> {
        let mut word = BLANK;
        let offset = self.offset_of(index);
        let read = self.flash.read(offset, &mut word);
        read.is_ok().then_some(word)
    }

    /// Index of the last seal that has been begun, readable or not; if there is any, the commit
    /// word has been written to its end.
    pub(super) fn last_seal(&mut self) -> Option<u16> {
        (1..=SEAL_WORDS)
            .rev()
            .find(|index| self.read(*index) != Some(BLANK))
    }

    fn offset_of(&self, index: u16) -> u32 {
        #[expect(clippy::cast_possible_truncation, reason = "32")]
        let word_bytes = WORD_BYTES as u32;
        self.offset + u32::from(index) * word_bytes
    }
}

impl<F: NorFlash> Slot<'_, F> {
    /// Erases the slot of so many bytes; `None` if the flash does not, or if commit word and seals
    /// are not blank then.
    pub(super) fn erase(&mut self, bytes: usize) -> Option<()> {
        let end = self.offset.checked_add(u32::try_from(bytes).ok()?)?;
        self.flash.erase(self.offset, end).ok()?;
        (0..BODY)
            .all(|index| self.read(index) == Some(BLANK))
            .then_some(())
    }

    /// Writes a word; `None` if the flash does not take it.
    pub(super) fn write(&mut self, index: u16, word: &Word) -> Option<()> {
        self.flash.write(self.offset_of(index), word).ok()
    }

    /// Writes a seal behind word `last`; `false` if none could be written. A word that was cut and
    /// read as blank may be among those behind: it does not read as a seal then, and the next is
    /// taken.
    pub(super) fn seal_behind(&mut self, last: u16) -> bool {
        let mut words = last.saturating_add(1)..=SEAL_WORDS;
        words.any(|index| self.write(index, &SEAL).is_some() && self.read(index) == Some(SEAL))
    }
}
