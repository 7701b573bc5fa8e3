//! Flash whose supply fails at a chosen word.
//!
//! A word holds 32 bytes under one ECC and is written once between two erasures. A write or an
//! erasure that is cut leaves words that read as blank, in part, as whole, otherwise at every
//! reading, or not at all; none of them takes a write before the next erasure.

use std::collections::BTreeSet;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use fmc_camera::io::store::SEAL_WORDS;
use fmc_camera::io::store::record_flash::RecordFlash;

pub(crate) const WORD: usize = 32;

/// Bytes of a sector, those of an STM32H743.
pub(crate) const SECTOR: usize = 128 * 1024;

pub(crate) type Bytes = [u8; WORD];

pub(crate) const BLANK: Bytes = [0xff; WORD];

/// State of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cell {
    /// Erased to the end: it takes a write.
    Blank,
    /// It reads as these bytes, which may be all ones.
    Holding(Bytes),
    /// It reads as the first, as the second, as a mixture of their bits, or not at all.
    Unstable(Bytes, Bytes),
    /// Its ECC finds an error.
    Failing,
}

/// Remains of a word, or of a sector, whose supply failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// So many bytes of the word are written; of a sector so many words are erased.
    First(usize),
    /// So many words of a sector are left, the others are erased.
    Left(usize),
    /// The word, or every word of the sector, is unstable.
    Unstable,
    /// None can be read.
    Failing,
    /// Every word of the sector is any of these.
    Mixed,
}

/// An operation that changes the flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operation {
    /// Erasure of a sector that had so many words.
    Erase(usize),
    /// Write of the word with this index in its sector.
    Write(usize),
}

impl Operation {
    /// Returns `true` for the write of a seal.
    pub(crate) fn is_seal(&self) -> bool {
        let seals = 1..=usize::from(SEAL_WORDS);
        matches!(self, Self::Write(word) if seals.contains(word))
    }

    /// Everything that can be left of it when it is cut.
    pub(crate) fn cuts(self) -> Vec<Cut> {
        let (most, others): (usize, &[Cut]) = match self {
            Self::Erase(words) => (words, &[Cut::Unstable, Cut::Failing, Cut::Mixed]),
            Self::Write(_) => (WORD, &[Cut::Unstable, Cut::Failing]),
        };
        let mut cuts: Vec<Cut> = (0..=most).map(Cut::First).collect();
        if let Self::Erase(words) = self {
            cuts.extend((1..words).map(Cut::Left));
        }
        cuts.extend(others);
        cuts
    }
}

/// The flash of a calibration.
pub(crate) type FlashModel = FlashOf<2, SECTOR>;

/// A flash of so many sectors of so many bytes.
#[derive(Debug, Clone)]
pub(crate) struct FlashOf<const SECTORS: usize, const BYTES: usize> {
    /// Words of each sector up to the last that is not blank.
    pub(crate) sectors: [Vec<Cell>; SECTORS],
    /// Operations since the last start.
    pub(crate) operations: Vec<Operation>,
    /// Number of the operation that is cut, and how.
    cut: Option<(usize, Cut)>,
    is_without_supply: bool,
    /// Words that were written again since the last start though they did not read as blank.
    pub(crate) written_again: usize,
    /// Sector and index of unstable words that have read as blank: nobody can know that they were
    /// begun.
    seen_blank: BTreeSet<(usize, usize)>,
    random: u64,
    /// Number of looks at an erasure that goes on, until it ends.
    pub(crate) erasure_looks: u32,
    /// Offset of the sector that is being erased, and looks that are left.
    erasing: Option<(u32, u32)>,
}

impl<const SECTORS: usize, const BYTES: usize> FlashOf<SECTORS, BYTES> {
    pub(crate) fn blank() -> Self {
        Self {
            sectors: [const { Vec::new() }; SECTORS],
            operations: Vec::new(),
            cut: None,
            is_without_supply: false,
            written_again: 0,
            seen_blank: BTreeSet::new(),
            random: 1,
            erasure_looks: 0,
            erasing: None,
        }
    }

    /// Returns the flash after its supply has come back.
    pub(crate) fn started(mut self) -> Self {
        self.operations.clear();
        self.written_again = 0;
        self.cut = None;
        self.is_without_supply = false;
        self.erasing = None;
        self
    }

    /// Returns the flash whose supply fails in an operation.
    pub(crate) fn cut_at(mut self, number: usize, cut: Cut) -> Self {
        self.cut = Some((number, cut));
        self
    }

    /// Returns the flash whose unstable words read otherwise.
    pub(crate) fn seeded(mut self, seed: u64) -> Self {
        self.random = self
            .random
            .wrapping_add(seed.wrapping_mul(0xd134_2543_de82_ef95));
        self
    }

    /// Returns a number of 64 bits (splitmix64).
    fn next_random(&mut self) -> u64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.random;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Notes an operation; what is left of it if it is the one that is cut.
    fn begin(&mut self, operation: Operation) -> Result<Option<Cut>, NorFlashErrorKind> {
        if self.is_without_supply {
            return Err(NorFlashErrorKind::Other);
        }
        let number = self.operations.len();
        self.operations.push(operation);
        match self.cut {
            Some((at, cut)) if at == number => {
                self.is_without_supply = true;
                Ok(Some(cut))
            }
            _ => Ok(None),
        }
    }

    /// Returns what an erasure that was cut leaves of a word.
    fn left_of(&mut self, cell: Cell, index: usize, cut: Cut) -> Cell {
        let erased = Cell::Holding(BLANK);
        let old = match cell {
            Cell::Holding(old) | Cell::Unstable(old, _) => old,
            Cell::Blank | Cell::Failing => BLANK,
        };
        let choice = self.next_random() % 4;
        match (cut, choice) {
            (Cut::First(erased), _) if index >= erased => cell,
            (Cut::Left(left), _) if index < left => cell,
            (Cut::Mixed, 0) => cell,
            (Cut::Unstable, _) | (Cut::Mixed, 1) => Cell::Unstable(old, BLANK),
            (Cut::Failing, _) | (Cut::Mixed, 2) => Cell::Failing,
            _ => erased,
        }
    }

    /// Sector and word of an offset.
    fn place(offset: u32) -> (usize, usize) {
        let offset = usize::try_from(offset).unwrap();
        (offset / BYTES, offset % BYTES / WORD)
    }
}

impl<const SECTORS: usize, const BYTES: usize> ErrorType for FlashOf<SECTORS, BYTES> {
    type Error = NorFlashErrorKind;
}

impl<const SECTORS: usize, const BYTES: usize> ReadNorFlash for FlashOf<SECTORS, BYTES> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        assert_eq!(bytes.len(), WORD, "the store reads by words");
        assert_eq!(self.erasing, None, "read during an erasure");
        let (sector, word) = Self::place(offset);
        let cell = self.sectors[sector].get(word).copied();
        let read = match cell.unwrap_or(Cell::Blank) {
            Cell::Blank => BLANK,
            Cell::Holding(held) => held,
            Cell::Failing => return Err(NorFlashErrorKind::Other),
            Cell::Unstable(one, other) => {
                let random = self.next_random();
                match random % 8 {
                    0..=2 => one,
                    3..=5 => other,
                    6 => {
                        let mut mixed = one;
                        for (bit, (mixed, other)) in mixed.iter_mut().zip(other).enumerate() {
                            if random >> (8 + bit) & 1 == 1 {
                                *mixed = other;
                            }
                        }
                        mixed
                    }
                    _ => return Err(NorFlashErrorKind::Other),
                }
            }
        };
        if matches!(cell, Some(Cell::Unstable(..))) {
            if read == BLANK {
                self.seen_blank.insert((sector, word));
            } else {
                self.seen_blank.remove(&(sector, word));
            }
        }
        bytes.copy_from_slice(&read);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SECTORS * BYTES
    }
}

impl<const SECTORS: usize, const BYTES: usize> NorFlash for FlashOf<SECTORS, BYTES> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        assert_eq!(to - from, u32::try_from(BYTES).unwrap());
        let (sector, _) = Self::place(from);
        let words = self.sectors[sector].len();
        match self.begin(Operation::Erase(words))? {
            None => self.sectors[sector].clear(),
            Some(cut) => {
                for index in 0..words {
                    let cell = self.sectors[sector][index];
                    self.sectors[sector][index] = self.left_of(cell, index, cut);
                }
                return Err(NorFlashErrorKind::Other);
            }
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        assert_eq!(bytes.len(), WORD, "the store writes by words");
        assert_eq!(self.erasing, None, "written during an erasure");
        let (sector, word) = Self::place(offset);
        let cut = self.begin(Operation::Write(word))?;
        let random = self.next_random();
        let cells = &mut self.sectors[sector];
        if cells.len() <= word {
            cells.resize(word + 1, Cell::Blank);
        }
        let cell = &mut cells[word];
        let whole = Bytes::try_from(bytes).unwrap();
        if *cell != Cell::Blank {
            // It is left to chance if the flash notices; the word is lost.
            let seemed_blank = match *cell {
                Cell::Unstable(..) => self.seen_blank.contains(&(sector, word)),
                held => held == Cell::Holding(BLANK),
            };
            self.written_again += usize::from(!seemed_blank);
            *cell = Cell::Failing;
            return if random.is_multiple_of(2) && cut.is_none() {
                Ok(())
            } else {
                Err(NorFlashErrorKind::Other)
            };
        }
        let mut torn = BLANK;
        *cell = match cut {
            None => {
                *cell = Cell::Holding(whole);
                return Ok(());
            }
            Some(Cut::First(written) | Cut::Left(written)) => {
                torn[..written].copy_from_slice(&whole[..written]);
                Cell::Holding(torn)
            }
            Some(Cut::Unstable | Cut::Mixed) => Cell::Unstable(BLANK, whole),
            Some(Cut::Failing) => Cell::Failing,
        };
        Err(NorFlashErrorKind::Other)
    }
}

impl<const SECTORS: usize, const BYTES: usize> RecordFlash for FlashOf<SECTORS, BYTES> {
    fn begin_erasure(&mut self, offset: u32) -> Result<(), Self::Error> {
        assert_eq!(self.erasing, None, "one erasure at a time");
        if self.is_without_supply {
            return Err(NorFlashErrorKind::Other);
        }
        self.erasing = Some((offset, self.erasure_looks));
        Ok(())
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        let (offset, left) = self.erasing.expect("an erasure goes on");
        if let Some(left) = left.checked_sub(1) {
            self.erasing = Some((offset, left));
            return None;
        }
        self.erasing = None;
        Some(self.erase(offset, offset + u32::try_from(BYTES).unwrap()))
    }
}
