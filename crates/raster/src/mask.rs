//! Mask of a frame: which pixels were seen.

use tiff::encoder::compression::{CompressionAlgorithm, Packbits};

use crate::header::pixels;
use crate::write_error::WriteError;

/// Rows of a strip of the mask.
pub(crate) const MASK_STRIP_ROWS: u32 = 64;

/// Mask of a frame, one bit per pixel: 1 where the pixel was seen (TIFF 6.0, page 37), coded as
/// runs of bytes while its rows come.
///
/// # Examples
/// ```
/// let mut mask = fmc_raster::Mask::new([20, 2]);
/// mask.push_row((0..20).map(|column| column >= 8))?;
/// mask.push_row((0..20).map(|_| false))?;
/// assert!(mask.is_complete());
/// # Ok::<(), fmc_raster::WriteError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mask {
    pub(crate) width_px: u32,
    pub(crate) height_px: u32,
    pub(crate) strips: Vec<Vec<u8>>,
    rows: u32,
    packed: Vec<u8>,
}

impl Mask {
    /// Returns a mask without rows.
    #[must_use]
    pub fn new([width_px, height_px]: [u32; 2]) -> Self {
        Self {
            width_px,
            height_px,
            strips: Vec::new(),
            rows: 0,
            packed: vec![0; pixels(width_px.div_ceil(8))],
        }
    }

    /// Adds the next row; pixels that are missing at its end were not seen.
    ///
    /// # Errors
    /// The mask has all its rows.
    pub fn push_row(&mut self, seen: impl IntoIterator<Item = bool>) -> Result<(), WriteError> {
        if self.is_complete() {
            return Err(WriteError::Rows {
                samples: pixels(self.width_px),
                bits: 1,
                row_samples: pixels(self.width_px),
                plan_bits: 1,
                left: 0,
            });
        }
        let mut seen = seen.into_iter().take(pixels(self.width_px));
        for byte in &mut self.packed {
            let bits = seen.by_ref().take(8);
            *byte = bits
                .zip([128, 64, 32, 16, 8, 4, 2, 1])
                .fold(0, |byte, (seen, bit)| if seen { byte | bit } else { byte });
        }
        if self.rows.is_multiple_of(MASK_STRIP_ROWS) {
            self.strips.push(Vec::new());
        }
        self.rows += 1;
        if let Some(strip) = self.strips.last_mut() {
            let written = Packbits.write_to(strip, &self.packed);
            written.map_err(|error| WriteError::encode(&error))?;
        }
        Ok(())
    }

    /// Returns whether all rows have come.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.rows == self.height_px
    }

    /// Returns a bound of its bytes in a file.
    #[must_use]
    pub fn bound_bytes([width_px, height_px]: [u32; 2]) -> u64 {
        let row = u64::from(width_px.div_ceil(8));
        let strips = u64::from(height_px.div_ceil(MASK_STRIP_ROWS));
        (row + row / 64 + 2) * u64::from(height_px) + strips * 16 + 1024
    }
}
