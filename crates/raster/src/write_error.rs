//! Reasons why a TIFF is not written.

use std::io;

use tiff::TiffError;

/// The reason why a TIFF is not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system did not take bytes.
    #[error("write: {0}")]
    Io(io::Error),
    /// A codec failed.
    #[error("encode: {0}")]
    Encode(String),
    /// The file became longer than its offsets reach.
    #[error("write: the file is longer than offsets of 32 bits reach")]
    TooLong,
    /// Rows that do not fit the layout.
    #[error(
        "{samples} samples of {bits} bits; allowed: rows of {row_samples} samples of {plan_bits} \
         bits, {left} rows"
    )]
    Rows {
        /// Samples that were given.
        samples: usize,
        /// Bits of each.
        bits: u16,
        /// Samples of a row.
        row_samples: usize,
        /// Bits of the layout.
        plan_bits: u16,
        /// Rows that are left.
        left: u32,
    },
    /// The frame was finished before its last strip or tile.
    #[error("{written} strips or tiles written of {expected}")]
    Unfinished {
        /// Strips or tiles that were written.
        written: u64,
        /// All of them.
        expected: u64,
    },
}

impl WriteError {
    pub(crate) fn encode(error: &io::Error) -> Self {
        Self::Encode(error.to_string())
    }
}

impl From<TiffError> for WriteError {
    fn from(error: TiffError) -> Self {
        match error {
            TiffError::IoError(error) => Self::Io(error),
            TiffError::IntSizeError | TiffError::LimitsExceeded => Self::TooLong,
            other => Self::Encode(other.to_string()),
        }
    }
}
