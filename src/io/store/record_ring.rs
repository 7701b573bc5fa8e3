//! A ring of entries in flash, each written once: the oldest make room for the newest.
//!
//! # Layout
//! A ring is a number of sectors in words of [`WORD_BYTES`] bytes, written once between two
//! erasures. A sector begins with a word that numbers its erasure; behind it come entries of
//! [`ENTRY_WORDS`] words. Entries are numbered by their places: the number tells sector, erasure
//! and place, so that one from before an erasure is not taken for a new one.
//!
//! # Writing
//! One word is written in each [`step`](RecordRing::step), and compared. The last of an entry has
//! its CRC-32, without which there is no entry. A word that cannot be written costs its entry's
//! place: the entry is written again behind it.
//!
//! The sector behind the one that is being filled is erased ahead. Its first word is written after
//! the erasure has ended, so that a sector in which it, or an entry, is found has been erased to
//! its end. Any other is erased before it is used, also one that reads as blank.
//!
//! # Reading
//! A start only reads. It finds the newest sector by first words and first entries, and its last
//! entry by the last first word that is not blank. The place behind that one may have been begun
//! though it reads as blank, and is left out.

use embedded_storage::nor_flash::NorFlash;

use super::layout::{LayoutError, WORD_BYTES};
use super::record_flash::RecordFlash;
use super::ring_entry::{BLANK, ENTRY_BYTES, Word, generation_of, sector_word};
pub use super::ring_entry::{CONTENTS_BYTES, ENTRY_WORDS, RingEntry};

/// Entries of a sector by whose numbers it is known, beside its first word.
const KNOWN_BY: u32 = 8;

/// Tries in a row, each at another place, after which the flash counts as worn.
const MOST_TRIES: u8 = 8;

/// Times at which the ring may begin to erase a sector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Erasing {
    /// Ahead of need: nothing is written for some seconds.
    Ahead,
    /// If few places are left.
    AtNeed,
    /// Not now.
    Never,
}

/// Work of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RingState {
    /// It takes an entry.
    Idle,
    /// An entry is being written.
    Writing,
    /// A sector is being erased; an entry may wait for it.
    Erasing,
    /// The flash takes no entry any more.
    Worn,
}

/// A ring of entries in a flash `F`.
#[derive(Debug, Clone)]
pub struct RecordRing<F> {
    flash: F,
    /// Offset of the first sector, bytes.
    offset: u32,
    sectors: u32,
    /// Number of the next place.
    next: u32,
    /// Number of the last sector, counted on through the ring, that has been erased to its end and
    /// has its first word; `None` if there is none.
    ready: Option<u32>,
    /// Number of the sector that is being erased.
    erasing: Option<u32>,
    /// Entry that is being written, and the number of its words that are.
    entry: Option<(RingEntry, u8)>,
    tries: u8,
    /// Sectors that were erased since the start.
    erasures: u32,
}

impl<F: RecordFlash> RecordRing<F> {
    /// Places of a sector; the first is that of its first word.
    const PLACES: u32 = {
        let places = F::ERASE_SIZE / ENTRY_BYTES;
        assert!(places > KNOWN_BY as usize && places <= 1 << 16);
        assert!(WORD_BYTES.is_multiple_of(F::READ_SIZE));
        assert!(WORD_BYTES.is_multiple_of(F::WRITE_SIZE));
        #[expect(clippy::cast_possible_truncation, reason = "at most 65,536")]
        let places = places as u32;
        places
    };

    /// Entries of a sector.
    pub const ENTRIES: u32 = Self::PLACES - 1;

    /// Places left in a sector at which the next is erased ahead, and at need: with the first, a
    /// ring of six sectors of 128 KB keeps at least 3,000 entries.
    const AHEAD_AT: u32 = Self::PLACES * 9 / 20;
    const NEED_AT: u32 = 8;

    /// Returns the ring of so many sectors from an offset of the flash, as it was found at the
    /// start.
    ///
    /// # Errors
    /// [`LayoutError`] if it has no place there, or fewer than three sectors.
    pub fn open(flash: F, offset: u32, sectors: u32) -> Result<Self, LayoutError> {
        let sector = F::ERASE_SIZE;
        let begin = usize::try_from(offset).unwrap_or(usize::MAX);
        if !begin.is_multiple_of(sector) {
            return Err(LayoutError::NoSector { offset, sector });
        }
        let count = usize::try_from(sectors.max(3)).unwrap_or(usize::MAX);
        let required = begin.saturating_add(count.saturating_mul(sector));
        let capacity = flash.capacity();
        if required > capacity || u32::try_from(required).is_err() || sectors < 3 {
            return Err(LayoutError::NoPlace { required, capacity });
        }
        let mut ring = Self {
            flash,
            offset,
            sectors,
            next: 1,
            ready: None,
            erasing: None,
            entry: None,
            tries: 0,
            erasures: 0,
        };
        ring.find_end();
        Ok(ring)
    }

    /// Most entries that the ring holds, with the sector blank that is to be written.
    #[must_use]
    pub const fn capacity(&self) -> u32 {
        (self.sectors - 1).saturating_mul(Self::ENTRIES)
    }

    /// Number of the sector of a place, counted on through the ring.
    #[must_use]
    pub const fn sector_of(place: u32) -> u32 {
        place / Self::PLACES
    }

    /// Number of the place that is written next.
    #[must_use]
    pub const fn next(&self) -> u32 {
        self.next
    }

    /// Sectors that were erased since the start.
    #[must_use]
    pub const fn erasures(&self) -> u32 {
        self.erasures
    }

    /// Work that it has.
    #[must_use]
    pub const fn state(&self) -> RingState {
        if self.tries >= MOST_TRIES {
            RingState::Worn
        } else if self.erasing.is_some() {
            RingState::Erasing
        } else if self.entry.is_some() {
            RingState::Writing
        } else {
            RingState::Idle
        }
    }

    /// Returns `true` while it has an entry that is not written to its end.
    #[must_use]
    pub const fn holds_entry(&self) -> bool {
        self.entry.is_some()
    }

    /// The flash.
    pub const fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Returns the flash.
    #[must_use]
    pub fn into_flash(self) -> F {
        self.flash
    }

    /// Takes an entry of these contents, which [`Self::step`] writes. Returns `false` while it
    /// [holds](Self::holds_entry) another, if it is worn, and for contents longer than
    /// [`CONTENTS_BYTES`].
    pub fn push(&mut self, contents: &[u8]) -> bool {
        if self.entry.is_some() || self.state() == RingState::Worn {
            return false;
        }
        self.entry = RingEntry::new(contents).map(|entry| (entry.numbered(self.next), 0));
        self.entry.is_some()
    }

    /// Does the next piece of the work: looks after an erasure, or writes one word. Returns the
    /// state after it.
    pub fn step(&mut self, erasing: Erasing) -> RingState {
        if self.tries >= MOST_TRIES {
            return RingState::Worn;
        }
        if let Some(sector) = self.erasing {
            if let Some(done) = self.flash.end_erasure() {
                self.erasing = None;
                let is_done = done.is_ok() && self.begin_sector(sector);
                self.count(is_done);
            }
            return self.state();
        }
        if self.entry.is_some() && self.is_ready() {
            self.write_word();
        } else if self.is_to_erase(erasing) {
            let sector = self.sector_to_erase();
            let begun = self.flash.begin_erasure(self.offset_of_sector(sector));
            if begun.is_ok() {
                self.erasing = Some(sector);
                self.erasures = self.erasures.saturating_add(1);
            } else {
                self.count(false);
            }
        }
        self.state()
    }

    /// Visits numbers and contents of entries, the newest first, until `visit` returns `false` or
    /// so many places have been read. Places that cannot be read, or hold no entry, are left out.
    pub fn newest_first<Visit>(&mut self, most: u32, mut visit: Visit)
    where
        Visit: FnMut(u32, &[u8]) -> bool,
    {
        let mut number = self.next;
        for _ in 0..most.min(self.capacity()) {
            let Some(before) = number.checked_sub(1) else {
                return;
            };
            number = before;
            let entry = self.read(number);
            if entry.is_some_and(|entry| !visit(number, entry.contents())) {
                return;
            }
        }
    }

    /// Finds where the entries end.
    fn find_end(&mut self) {
        let sectors = 0..self.sectors;
        let newest = sectors.filter_map(|sector| self.generation(sector)).max();
        self.ready = newest;
        let Some(newest) = newest else {
            return;
        };
        let mut last = self.last_used(newest);
        let before = newest.checked_sub(1);
        if last.is_multiple_of(Self::PLACES)
            && let Some(before) = before
            && self.generation(self.index_of(before)) == Some(before)
        {
            // The newest sector has been erased ahead.
            last = self.last_used(before);
        }
        // The place behind it may have been begun.
        self.next = Self::behind(Self::behind(last));
    }

    /// Number of the sector in a place of the ring, counted on through the ring; `None` if it has
    /// not been erased to its end.
    fn generation(&mut self, index: u32) -> Option<u32> {
        let sectors = self.sectors;
        let is_here = |sector: &u32| sector.checked_rem(sectors) == Some(index);
        let first = self.read_word(self.offset_of_index(index));
        let told = first.and_then(|word| generation_of(&word)).filter(is_here);
        if told.is_some() {
            return told;
        }
        (1..=KNOWN_BY).find_map(|place| {
            let offset = self.offset_of_index(index) + place * ENTRY_SIZE;
            let word = self.read_word(offset)?;
            let [_, _, n0, n1, n2, n3, ..] = word;
            let number = u32::from_le_bytes([n0, n1, n2, n3]);
            let sector = number / Self::PLACES;
            let is_here =
                is_here(&sector) && number % Self::PLACES == place && self.read(number).is_some();
            is_here.then_some(sector)
        })
    }

    /// Number of the last place of a sector that is not blank; that of its first word if all others
    /// are.
    fn last_used(&mut self, sector: u32) -> u32 {
        let first = sector.saturating_mul(Self::PLACES);
        let mut places = (1..Self::PLACES).rev();
        let last = places.find(|place| {
            let offset = self.offset_of(first.saturating_add(*place));
            self.read_word(offset) != Some(BLANK)
        });
        first.saturating_add(last.unwrap_or(0))
    }

    /// Number of the place behind another; the first of a sector is that of its first word.
    const fn behind(number: u32) -> u32 {
        let next = number.saturating_add(1);
        if next.is_multiple_of(Self::PLACES) {
            next.saturating_add(1)
        } else {
            next
        }
    }

    /// Returns `true` if the sector of the next place has been erased.
    fn is_ready(&self) -> bool {
        self.ready >= Some(self.next / Self::PLACES)
    }

    /// The sector to be erased next: that of the next place, or the one behind it.
    fn sector_to_erase(&self) -> u32 {
        let sector = self.next / Self::PLACES;
        sector.saturating_add(u32::from(self.is_ready()))
    }

    fn is_to_erase(&self, erasing: Erasing) -> bool {
        let left = Self::PLACES - self.next % Self::PLACES;
        let is_needed = self.ready < Some(self.next / Self::PLACES + 1);
        match erasing {
            _ if !self.is_ready() && self.entry.is_some() => erasing != Erasing::Never,
            Erasing::Ahead => !self.is_ready() || is_needed && left <= Self::AHEAD_AT,
            Erasing::AtNeed => is_needed && left <= Self::NEED_AT,
            Erasing::Never => false,
        }
    }

    /// Writes the first word of a sector that has been erased; `false` if it does not take it.
    fn begin_sector(&mut self, sector: u32) -> bool {
        let offset = self.offset_of_sector(sector);
        let is_begun = self.write(offset, &sector_word(sector));
        if is_begun {
            self.ready = Some(sector);
        }
        is_begun
    }

    /// Writes the next word of the entry.
    fn write_word(&mut self) {
        let Some((entry, written)) = self.entry else {
            return;
        };
        let Some(word) = entry.words().get(usize::from(written)) else {
            self.entry = None;
            return;
        };
        let offset = self.offset_of(self.next) + u32::from(written) * WORD_SIZE;
        if !self.write(offset, word) {
            self.next = Self::behind(self.next);
            self.entry = Some((entry.numbered(self.next), 0));
            self.count(false);
            return;
        }
        self.entry = Some((entry, written + 1));
        if usize::from(written) + 1 == ENTRY_WORDS {
            self.entry = None;
            self.next = Self::behind(self.next);
            self.count(true);
        }
    }

    /// Counts what cannot be written, in a row.
    const fn count(&mut self, is_done: bool) {
        self.tries = if is_done {
            0
        } else {
            self.tries.saturating_add(1)
        };
    }

    /// Writes a word and compares it.
    fn write(&mut self, offset: u32, word: &Word) -> bool {
        self.flash.write(offset, word).is_ok() && self.read_word(offset).as_ref() == Some(word)
    }

    fn read_word(&mut self, offset: u32) -> Option<Word> {
        let mut word = BLANK;
        let read = self.flash.read(offset, &mut word);
        read.is_ok().then_some(word)
    }

    /// Reads the entry of a number; `None` if there is none any more, or it is damaged. It is not
    /// called while a sector is being erased.
    pub fn read(&mut self, number: u32) -> Option<RingEntry> {
        let mut words = [BLANK; ENTRY_WORDS];
        let mut offset = self.offset_of(number);
        for (index, place) in words.iter_mut().enumerate() {
            *place = self.read_word(offset)?;
            if index == 0 && *place == BLANK {
                return None;
            }
            offset += WORD_SIZE;
        }
        RingEntry::parse(&words, number)
    }

    /// Offset of a place.
    fn offset_of(&self, number: u32) -> u32 {
        self.offset_of_sector(number / Self::PLACES) + number % Self::PLACES * ENTRY_SIZE
    }

    /// Offset of a sector by its number, counted on through the ring.
    fn offset_of_sector(&self, sector: u32) -> u32 {
        self.offset_of_index(self.index_of(sector))
    }

    /// Place of a sector in the ring.
    fn index_of(&self, sector: u32) -> u32 {
        sector.checked_rem(self.sectors).unwrap_or(0)
    }

    /// Offset of the sector in a place of the ring.
    fn offset_of_index(&self, index: u32) -> u32 {
        #[expect(clippy::cast_possible_truncation, reason = "a flash has 32 bits")]
        let sector_bytes = <F as NorFlash>::ERASE_SIZE as u32;
        self.offset.wrapping_add(index.wrapping_mul(sector_bytes))
    }
}

/// Bytes of a word and of an entry, as offsets have them.
#[expect(clippy::cast_possible_truncation, reason = "32")]
const WORD_SIZE: u32 = WORD_BYTES as u32;
#[expect(clippy::cast_possible_truncation, reason = "192")]
const ENTRY_SIZE: u32 = ENTRY_BYTES as u32;
