//! A flash in the machine's PSRAM, which a reset leaves alone: sectors of 128 KB in words of 32
//! bytes, as in bank 2 of an STM32H743; two for the calibration, six for records.
//!
//! A word is written once between two erasures. Beside it stands its CRC-32, in the place of an
//! ECC: a word whose bytes and CRC-32 do not fit each other, as after QEMU has been killed between
//! the two, cannot be read. All bits are kept inverted, so that the zeros with which the machine
//! starts are a flash that has been erased. A PC that shares the memory keeps the flash in a file.

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

use fmc_camera::io::store::record_flash::RecordFlash;

use super::registers::SharedMemory;

/// Places of the words in the memory: of the calibration, and of the records.
const CALIBRATION_AT: usize = 0x10_0000;
const RECORDS_AT: usize = 0x20_0000;
const SECTOR: usize = 0x2_0000;
const CALIBRATION_SECTORS: usize = 2;
pub(super) const RECORD_SECTORS: usize = 6;
const WORD: usize = 32;
/// Bytes of a machine's word, which is written at once.
const PIECE: usize = size_of::<u32>();

/// Table-free, since words are few and memory is scarce.
const CRC: Crc<u32, Table<0>> = Crc::<u32, Table<0>>::new(&CRC_32_ISO_HDLC);

/// A part of the flash.
#[derive(Clone, Copy)]
pub(crate) struct Flash {
    memory: SharedMemory,
    words_at: usize,
    capacity: usize,
    /// Offset of the sector of which an erasure has been begun.
    erasing: Option<u32>,
}

impl Flash {
    /// The part of the calibration.
    pub(super) const fn of_calibration(memory: SharedMemory) -> Self {
        Self::of(memory, CALIBRATION_AT, CALIBRATION_SECTORS)
    }

    /// The part of the records.
    pub(super) const fn of_records(memory: SharedMemory) -> Self {
        Self::of(memory, RECORDS_AT, RECORD_SECTORS)
    }

    const fn of(memory: SharedMemory, words_at: usize, sectors: usize) -> Self {
        Self {
            memory,
            words_at,
            capacity: sectors * SECTOR,
            erasing: None,
        }
    }

    /// Places of the pieces of the word with this offset, and of its CRC-32: these are behind the
    /// words.
    fn places(self, offset: usize) -> (impl Iterator<Item = usize>, usize) {
        let first = self.words_at + offset;
        let check = self.words_at + self.capacity + offset / WORD * PIECE;
        ((first..first + WORD).step_by(PIECE), check)
    }

    fn is_blank(self, offset: usize) -> bool {
        let (mut pieces, check) = self.places(offset);
        self.memory.read_word(check) == 0 && pieces.all(|at| self.memory.read_word(at) == 0)
    }

    fn read_word(self, offset: usize, word: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let (pieces, check) = self.places(offset);
        for (at, bytes) in pieces.zip(word.chunks_mut(PIECE)) {
            let piece = (!self.memory.read_word(at)).to_le_bytes();
            for (place, byte) in bytes.iter_mut().zip(piece) {
                *place = byte;
            }
        }
        if self.is_blank(offset) || !self.memory.read_word(check) == CRC.checksum(word) {
            Ok(())
        } else {
            Err(NorFlashErrorKind::Other)
        }
    }

    fn write_word(self, offset: usize, word: &[u8]) -> Result<(), NorFlashErrorKind> {
        if !self.is_blank(offset) {
            return Err(NorFlashErrorKind::Other);
        }
        let (pieces, check) = self.places(offset);
        for (at, bytes) in pieces.zip(word.chunks(PIECE)) {
            if let Ok(piece) = bytes.try_into() {
                self.memory.write_word(at, !u32::from_le_bytes(piece));
            }
        }
        self.memory.write_word(check, !CRC.checksum(word));
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = WORD;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let first = usize::try_from(offset).unwrap_or(usize::MAX);
        for (offset, word) in (first..).step_by(WORD).zip(bytes.chunks_mut(WORD)) {
            self.read_word(offset, word)?;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.capacity
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        for offset in (from..to).step_by(WORD) {
            let (pieces, check) = self.places(usize::try_from(offset).unwrap_or(usize::MAX));
            for at in pieces {
                self.memory.write_word(at, 0);
            }
            self.memory.write_word(check, 0);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        let first = usize::try_from(offset).unwrap_or(usize::MAX);
        for (offset, word) in (first..).step_by(WORD).zip(bytes.chunks(WORD)) {
            self.write_word(offset, word)?;
        }
        Ok(())
    }
}

impl RecordFlash for Flash {
    /// The erasure takes place when it is looked for: it takes no time.
    fn begin_erasure(&mut self, offset: u32) -> Result<(), Self::Error> {
        self.erasing = Some(offset);
        Ok(())
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        let offset = self.erasing.take()?;
        let end = u32::try_from(SECTOR)
            .ok()
            .and_then(|it| offset.checked_add(it));
        Some(end.map_or(Err(NorFlashErrorKind::OutOfBounds), |end| {
            self.erase(offset, end)
        }))
    }
}
