//! CRC-32 of a frame's pixels.

use crate::sample::Sample;

/// CRC-32 (IEEE 802.3) of interleaved samples in little-endian order, row by row: the same for
/// every layout, compression and byte order of a file.
///
/// # Examples
/// ```
/// let mut crc = fmc_raster::PixelCrc::default();
/// crc.update::<u8>(b"12345");
/// crc.update::<u8>(b"6789");
/// assert_eq!(crc.value(), 0xcbf4_3926);
/// ```
#[derive(Clone, Debug, Default)]
pub struct PixelCrc(crc32fast::Hasher);

impl PixelCrc {
    /// Adds the next samples.
    pub fn update<S: Sample>(&mut self, samples: &[S]) {
        if cfg!(target_endian = "little") || S::BITS == 8 {
            self.0.update(bytemuck::cast_slice(samples));
        } else {
            for sample in samples {
                self.0.update(bytemuck::bytes_of(&sample.swapped()));
            }
        }
    }

    /// Returns the CRC of all samples so far.
    #[must_use]
    pub fn value(&self) -> u32 {
        self.0.clone().finalize()
    }
}
