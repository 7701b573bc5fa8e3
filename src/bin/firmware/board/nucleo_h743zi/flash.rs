//! The second bank of the chip's flash: eight sectors of 128 KB in words of 32 bytes with an ECC,
//! each written once between two erasures (RM0433, section 4).
//!
//! The image runs from the first bank, which goes on while the second is erased or written. The
//! memory protection lets the second be written only while this module does so. Its memory is past
//! the cache. A word that its ECC cannot correct is an error of the read, not a fault of the
//! processor (`flash_words.rs`).

use embassy_stm32::pac;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, ReadNorFlash, check_erase, check_read, check_write,
};
use fmc_camera::io::store::record_flash::RecordFlash;

use super::{
    clock,
    flash_error::FlashError,
    flash_words::{self, WORD},
    regions, watchdog,
};

/// Bytes of a sector.
const SECTOR: u32 = 128 << 10;

/// Sectors of the calibration, one for each slot, and behind them those of the records.
const CALIBRATION_SECTORS: u32 = 2;
pub(super) const RECORD_SECTORS: u32 = 6;

/// Keys that unlock the bank.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Longest time of an erasure of a sector, and of a write of a word, µs: the data sheet has 4 s and
/// 0.58 ms, at the least parallelism.
const ERASURE_US: u32 = 5_000_000;
const WRITE_US: u32 = 10_000;

/// Time from one feeding of the watchdog to the next while the bank is busy, µs. It goes by the
/// clock: where that stands still, nobody feeds.
const FEED_US: u32 = 100_000;

/// A part of the second bank.
#[derive(Debug)]
pub(crate) struct Flash {
    /// Its first sector.
    first: u32,
    sectors: u32,
    /// Time at which an erasure was begun that goes on beside the program, µs.
    erasing_since: Option<u32>,
}

impl Flash {
    /// Returns the part of the calibration; `None` if the option bytes have swapped the banks, so
    /// that the image may be in this one.
    pub(super) fn for_calibration() -> Option<Self> {
        Self::of(0, CALIBRATION_SECTORS)
    }

    /// Returns the part of the records, in the same way.
    pub(super) fn for_records() -> Option<Self> {
        Self::of(CALIBRATION_SECTORS, RECORD_SECTORS)
    }

    fn of(first: u32, sectors: u32) -> Option<Self> {
        if pac::FLASH.optcr().read().swap_bank() {
            defmt::error!("the banks of the flash are swapped: nothing is stored");
            return None;
        }
        Some(Self {
            first,
            sectors,
            erasing_since: None,
        })
    }

    /// Offset in the bank of an offset in this part.
    const fn in_bank(&self, offset: u32) -> u32 {
        self.first * SECTOR + offset
    }
}

/// Registers of the bank.
fn bank() -> pac::flash::Bank {
    pac::FLASH.bank(1)
}

/// Clears the flags of what was before.
fn clear() {
    bank().ccr().write(|w| {
        w.set_clr_eop(true);
        w.set_clr_wrperr(true);
        w.set_clr_pgserr(true);
        w.set_clr_strberr(true);
        w.set_clr_incerr(true);
        w.set_clr_operr(true);
        w.set_clr_rdperr(true);
        w.set_clr_rdserr(true);
        w.set_clr_sneccerr(true);
        w.set_clr_dbeccerr(true);
    });
}

/// Waits until the bank has done what it was told. The watchdog is fed meanwhile.
fn wait(longest_us: u32) -> Result<(), FlashError> {
    cortex_m::asm::dsb();
    let start = clock::now_us();
    let mut fed = start;
    watchdog::feed();
    loop {
        let status = bank().sr().read();
        if !(status.bsy() || status.qw()) {
            if let Some(error) = FlashError::of(status) {
                return Err(error);
            }
            // A part of a word waits for the rest.
            if !status.wbne() {
                return Ok(());
            }
        }
        let now = clock::now_us();
        if now.wrapping_sub(start) > longest_us {
            return Err(FlashError::TimedOut);
        }
        if now.wrapping_sub(fed) > FEED_US {
            fed = now;
            watchdog::feed();
        }
    }
}

/// Makes sure that the bank has nothing to do, and clears its flags. A bank that is busy would hold
/// the processor until it has ended.
fn begin() -> Result<(), FlashError> {
    let status = bank().sr().read();
    if status.bsy() || status.qw() {
        return Err(FlashError::Busy);
    }
    clear();
    Ok(())
}

/// Unlocks the bank's registers.
fn unlock() -> Result<(), FlashError> {
    begin()?;
    if bank().cr().read().lock() {
        for key in KEYS {
            bank().keyr().write_value(key);
        }
        if bank().cr().read().lock() {
            return Err(FlashError::Locked);
        }
    }
    Ok(())
}

/// Locks them again, after what was done.
fn lock(done: Result<(), FlashError>) -> Result<(), FlashError> {
    // The registers of a bank that is busy cannot be written.
    if done != Err(FlashError::TimedOut) {
        bank().cr().modify(|w| {
            w.set_pg(false);
            w.set_ser(false);
            w.set_lock(true);
        });
        clear();
    }
    done
}

/// Does something with the bank unlocked and open for writing.
fn unlocked(act: impl FnOnce() -> Result<(), FlashError>) -> Result<(), FlashError> {
    unlock()?;
    regions::open_bank_2();
    let done = act();
    regions::close_bank_2();
    lock(done)
}

/// Reads a word.
fn read_word(offset: u32) -> Result<[u8; WORD], FlashError> {
    begin()?;
    let word = flash_words::read(offset).ok_or(FlashError::Unreadable);
    let status = bank().sr().read();
    clear();
    if status.sneccerr1() {
        defmt::warn!("flash at {=u32:#x}: a bit was corrected", offset);
    }
    match FlashError::of(status) {
        Some(error) => Err(error),
        None => word,
    }
}

/// Writes a word that is blank.
fn write_word(offset: u32, word: &[u8]) -> Result<(), FlashError> {
    if read_word(offset)? != [0xff; WORD] {
        return Err(FlashError::NotBlank);
    }
    unlocked(|| {
        bank().cr().modify(|w| {
            w.set_ser(false);
            w.set_pg(true);
        });
        flash_words::write(offset, word);
        wait(WRITE_US)
    })
}

/// Lets the bank, which is unlocked, erase the sector that begins at an offset.
fn start_erasure(offset: u32) {
    let [sector, ..] = (offset / SECTOR).to_le_bytes();
    bank().cr().modify(|w| {
        w.set_pg(false);
        w.set_ser(true);
        w.set_snb(sector);
    });
    bank().cr().modify(|w| w.set_start(true));
}

/// Erases the sector that begins at an offset.
fn erase_sector(offset: u32) -> Result<(), FlashError> {
    unlocked(|| {
        start_erasure(offset);
        wait(ERASURE_US)
    })
}

/// Logs an error with the place where it has come.
fn noted(offset: u32, done: Result<(), FlashError>) -> Result<(), FlashError> {
    if let Err(error) = done {
        defmt::warn!("flash at {=u32:#x}: {}", offset, error);
    }
    done
}

impl ErrorType for Flash {
    type Error = FlashError;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = WORD;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len())?;
        let first = self.in_bank(offset);
        for (offset, place) in (first..).step_by(WORD).zip(bytes.chunks_mut(WORD)) {
            let word = read_word(offset);
            noted(offset, word.map(|_| ()))?;
            for (byte, value) in place.iter_mut().zip(word?) {
                *byte = value;
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        (self.sectors * SECTOR) as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to)?;
        let sectors = self.in_bank(from)..self.in_bank(to);
        for offset in sectors.step_by(Self::ERASE_SIZE) {
            noted(offset, erase_sector(offset))?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len())?;
        let first = self.in_bank(offset);
        for (offset, word) in (first..).step_by(WORD).zip(bytes.chunks(WORD)) {
            noted(offset, write_word(offset, word))?;
        }
        Ok(())
    }
}

impl RecordFlash for Flash {
    fn begin_erasure(&mut self, offset: u32) -> Result<(), FlashError> {
        check_erase(self, offset, offset.saturating_add(SECTOR))?;
        let offset = self.in_bank(offset);
        noted(offset, unlock())?;
        start_erasure(offset);
        self.erasing_since = Some(clock::now_us());
        Ok(())
    }

    fn end_erasure(&mut self) -> Option<Result<(), FlashError>> {
        let since = self.erasing_since?;
        let status = bank().sr().read();
        let done = if !(status.bsy() || status.qw()) {
            FlashError::of(status).map_or(Ok(()), Err)
        } else if clock::now_us().wrapping_sub(since) > ERASURE_US {
            Err(FlashError::TimedOut)
        } else {
            return None;
        };
        self.erasing_since = None;
        Some(noted(self.first * SECTOR, lock(done)))
    }
}
