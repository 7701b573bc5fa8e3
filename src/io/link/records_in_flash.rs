//! Copies of the records in flash, as the status tells of them.

use serde::{Deserialize, Serialize};

/// Copies of the records in flash.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RecordsInFlash {
    /// The camera makes none.
    NotKept,
    /// All are there but so many, which a loss of the supply would take now.
    AllBut(u32),
    /// The flash takes no more.
    Worn,
}
