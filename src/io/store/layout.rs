//! Sizes of slots, records and words.

use core::fmt;

use super::authentication::Signature;
use super::origin::{DATE_BYTES, LABORATORY_BYTES, LENS_BYTES};
use crate::geometry::grid::MAX_FILE_BYTES;
use crate::io::link::CALIBRATION_CAPACITY;

/// Bytes of a word, which is written once between two erasures: as many as the flash of an
/// STM32H743 protects by one ECC. A flash with shorter words writes several.
pub const WORD_BYTES: usize = 32;

/// Seals of a slot.
pub const SEAL_WORDS: u16 = 7;

/// Version of the format of a record. It changes whenever body or parameters do; the commit word
/// keeps its layout in every version, so that a firmware names a record that it cannot read.
pub const FORMAT_VERSION: u16 = 3;

/// Oldest version that is read, too: in version 3 a focus table may stand behind the parameters.
pub const OLDEST_FORMAT: u16 = 2;

/// Most bytes of an origin: its texts with their lengths.
pub(super) const ORIGIN_BYTES: usize = 3 + LENS_BYTES + LABORATORY_BYTES + DATE_BYTES;

/// Most bytes of a permission that may be missing: two numbers of up to five bytes.
pub(super) const PERMISSION_BYTES: usize = 1 + 2 * 5;

/// Most bytes of a record's head: its length, the origin, the signature, the permission, the
/// highest version, five numbers of the probe point and four that take up to five bytes, two
/// lengths of grids, and the parameters.
pub(super) const HEAD_BYTES: usize = 2
    + ORIGIN_BYTES
    + (Signature::BYTES + PERMISSION_BYTES)
    + 5
    + (5 * 4 + 4 * 5)
    + 2 * 3
    + (2 + CALIBRATION_CAPACITY);

/// The same in whole words.
pub(super) const HEAD_CAPACITY: usize = HEAD_BYTES.next_multiple_of(WORD_BYTES);

/// Most words of a body.
#[expect(clippy::cast_possible_truncation, reason = "about a thousand")]
pub const MAX_BODY_WORDS: u16 =
    (HEAD_CAPACITY / WORD_BYTES + 2 * MAX_FILE_BYTES.div_ceil(WORD_BYTES)) as u16;

/// Most bytes of a slot; it has as many sectors as hold them.
pub const MAX_SLOT_BYTES: usize = (1 + SEAL_WORDS as usize + MAX_BODY_WORDS as usize) * WORD_BYTES;

/// The reason why a flash has no place for a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LayoutError {
    /// The store does not begin with a sector.
    NoSector {
        /// Offset of the store, bytes.
        offset: u32,
        /// Bytes of a sector.
        sector: usize,
    },
    /// The flash ends before the store does.
    NoPlace {
        /// Bytes that the flash has to have.
        required: usize,
        /// Bytes that it has.
        capacity: usize,
    },
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSector { offset, sector } => write!(
                f,
                "the store begins at byte {offset}, which is no multiple of a sector of {sector} bytes"
            ),
            Self::NoPlace { required, capacity } => write!(
                f,
                "the store ends at byte {required} of a flash of {capacity} bytes"
            ),
        }
    }
}

impl core::error::Error for LayoutError {}
