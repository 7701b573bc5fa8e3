//! Memory for the file of one residual grid.

use heapless::Vec;

use super::grid_error::GridError;
use super::range::MAX_FILE_BYTES;
use super::residual_grid::{GridSummary, ResidualGrid};

/// Memory for the file of one residual grid, which comes in parts and is checked once.
#[derive(Debug)]
pub struct GridBuffer {
    bytes: Vec<u8, MAX_FILE_BYTES>,
    /// Empty until the file has been checked. An empty vector is all zeros, so that a program need
    /// not store the contents of an empty buffer.
    checked: Vec<GridSummary, 1>,
}

impl GridBuffer {
    /// A buffer without a grid.
    pub const EMPTY: Self = Self {
        bytes: Vec::new(),
        checked: Vec::new(),
    };

    /// Forgets the grid.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.checked.clear();
    }

    /// Bytes of the file that have come.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Adds the next bytes of the file. The grid is to be checked anew.
    ///
    /// # Errors
    /// [`GridError::TooLong`] for a file longer than [`MAX_FILE_BYTES`]; nothing is added then.
    pub fn add(&mut self, bytes: &[u8]) -> Result<(), GridError> {
        self.checked.clear();
        let added = self.bytes.extend_from_slice(bytes);
        added.map_err(|_| GridError::TooLong {
            bytes: self.bytes.len().saturating_add(bytes.len()),
        })
    }

    /// Checks the file, and returns the CRC-32 with which it ends.
    ///
    /// # Errors
    /// As [`ResidualGrid::parse`].
    pub fn check(&mut self) -> Result<u32, GridError> {
        let checked = ResidualGrid::parse(&self.bytes)?.summary();
        self.checked.clear();
        // There is room for one.
        let _ = self.checked.push(checked);
        Ok(checked.crc32)
    }

    /// CRC-32 with which the file ends; `None` unless it has been checked.
    #[must_use]
    pub fn crc32(&self) -> Option<u32> {
        self.checked.first().map(|checked| checked.crc32)
    }

    /// The grid; `None` unless it has been checked.
    #[must_use]
    pub fn grid(&self) -> Option<ResidualGrid<'_>> {
        ResidualGrid::again(*self.checked.first()?, &self.bytes)
    }
}
