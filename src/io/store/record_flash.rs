//! Flash whose erasures end by themselves while the program goes on.

use embedded_storage::nor_flash::NorFlash;

/// A flash that holds records in flight, where the program must not stand still for seconds.
pub trait RecordFlash: NorFlash {
    /// Begins to erase the sector at an offset.
    ///
    /// # Errors
    /// What keeps the flash from it: nothing has been begun then.
    fn begin_erasure(&mut self, offset: u32) -> Result<(), Self::Error>;

    /// Returns what has come of the erasure, once; `None` while it goes on. The flash is neither
    /// read nor written before.
    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>>;
}
