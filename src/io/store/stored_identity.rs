//! Identity of a stored calibration, as the link tells it.

use serde::{Deserialize, Serialize};

use super::fault::SlotFault;
use super::origin::Origin;
use crate::flight::calibration_id::CalibrationId;

/// A stored calibration without its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredIdentity {
    /// Identity: serial number, version, CRC-32.
    pub id: CalibrationId,
    /// Origin.
    pub origin: Origin,
    /// Number of its store, by which a permission names it ([`Permission`](super::Permission)).
    pub store: u32,
    /// Highest version that this camera has ever stored: without a permission only a higher one is
    /// stored.
    pub highest_version: u32,
    /// Slot in which it lies, 0 or 1.
    pub slot: u8,
    /// Fault of the other slot; `None` if its record is older, or was not read.
    pub other: Option<SlotFault>,
    /// `true` if a seal shows that the store was carried to its end. Otherwise it was cut, and a
    /// later start may find the calibration before: it is to be stored again.
    pub is_sealed: bool,
}
