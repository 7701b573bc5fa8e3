//! Errors of the chip's flash, by the flags of its bank (RM0433, `FLASH_SR2`).

use embassy_stm32::pac::flash::regs::Sr;
use embedded_storage::nor_flash::{NorFlashError, NorFlashErrorKind};

/// The reason why the flash does not do what it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub(crate) enum FlashError {
    /// The place is not one of this flash.
    OutOfBounds,
    /// The place is not a whole word or sector.
    NotAligned,
    /// The keys do not unlock the bank until a reset.
    Locked,
    /// The bank is still busy with what was begun before.
    Busy,
    /// It has not ended within its time.
    TimedOut,
    /// The word has been written since the last erasure.
    NotBlank,
    /// More bits of the word are wrong than its ECC corrects (DBECCERR, or a fault of the bus).
    Unreadable,
    /// The sector is protected from writing by the option bytes (WRPERR).
    WriteProtected,
    /// A write that was not allowed, or that came after an error (PGSERR).
    Sequence,
    /// A byte of a word was written twice (STRBERR).
    Strobe,
    /// A word was left before it was whole (INCERR).
    Incomplete,
    /// The bank could not carry it out (OPERR).
    Operation,
    /// The sector is protected from reading by the option bytes (RDPERR, RDSERR).
    ReadProtected,
}

impl FlashError {
    /// Returns the error that the flags tell of; a bit that was corrected is none.
    pub(super) fn of(status: Sr) -> Option<Self> {
        let flags = [
            (status.wrperr(), Self::WriteProtected),
            (status.pgserr(), Self::Sequence),
            (status.strberr(), Self::Strobe),
            (status.incerr(), Self::Incomplete),
            (status.operr(), Self::Operation),
            (status.rdperr() || status.rdserr(), Self::ReadProtected),
            (status.dbeccerr(), Self::Unreadable),
        ];
        flags
            .into_iter()
            .find_map(|(is_set, error)| is_set.then_some(error))
    }
}

impl From<NorFlashErrorKind> for FlashError {
    fn from(kind: NorFlashErrorKind) -> Self {
        match kind {
            NorFlashErrorKind::NotAligned => Self::NotAligned,
            _ => Self::OutOfBounds,
        }
    }
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            _ => NorFlashErrorKind::Other,
        }
    }
}
