//! Layout of an output.

use crate::header::{Chunks, Compression, Header, SIDE_LIMIT_PX, compression_predicts};
use crate::tag::Tag;

/// Largest decoded strip or tile that is compressed; a compressed input whose strips are longer
/// gets strips of [`SHORT_STRIP_ROWS`].
pub const CHUNK_LIMIT_BYTES: u64 = 64 << 20;
/// Longest row of tiles that an output has because its input has it; those of a longer one become
/// strips of [`SHORT_STRIP_ROWS`].
pub const TILE_ROW_LIMIT_BYTES: u64 = 256 << 20;
/// Rows of the strips that replace longer ones.
pub const SHORT_STRIP_ROWS: u32 = 64;
/// Largest file whose offsets have 32 bits, with room for what programs append.
pub const CLASSIC_LIMIT_BYTES: u64 = (4 << 30) - (64 << 10);

/// Wishes for the output; without one it is as the input.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct PlanOptions {
    /// Compression.
    pub compression: Option<Compression>,
    /// Strips of so many rows, or tiles.
    pub chunks: Option<Chunks>,
    /// BigTIFF whatever the size.
    pub big: bool,
}

/// Layout of an output: size, samples, compression, strips or tiles, container.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct FramePlan {
    pub(crate) width_px: u32,
    pub(crate) height_px: u32,
    pub(crate) samples: u16,
    pub(crate) bits: u16,
    pub(crate) photometric: u16,
    pub(crate) extra_samples: Vec<u16>,
    pub(crate) compression: Compression,
    pub(crate) predictor: bool,
    pub(crate) chunks: Chunks,
    pub(crate) big: bool,
}

/// The reason why an output cannot be laid out as asked.
#[derive(Clone, Copy, Debug, Eq, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// Size outside the range.
    #[error("{tag} = {px} px; allowed: 1 to 300000 px")]
    Size {
        /// Width or height.
        tag: Tag,
        /// Its value.
        px: u32,
    },
    /// Side of a tile that is no multiple of 16 in the range.
    #[error("{tag} = {px} px; allowed: multiples of 16 from 16 to 8192 px")]
    Tile {
        /// Width or height.
        tag: Tag,
        /// Its value.
        px: u32,
    },
    /// No rows in a strip.
    #[error("RowsPerStrip (278) = 0; allowed: 1 and more")]
    NoRows,
    /// A strip or tile that is compressed is too large.
    #[error("a strip or tile of {bytes} bytes; allowed with compression: {limit} bytes")]
    ChunkTooLarge {
        /// Its size.
        bytes: u64,
        /// Largest size.
        limit: u64,
    },
}

impl FramePlan {
    /// Lays out an output of a size as its input, but for what is asked.
    ///
    /// Planes become chunky, Deflate of either number becomes 8. A compressed input with strips
    /// above [`CHUNK_LIMIT_BYTES`], and one with tiles above it or with a row of tiles above
    /// [`TILE_ROW_LIMIT_BYTES`], gets strips of [`SHORT_STRIP_ROWS`], which [`FramePlan::chunks`]
    /// tells.
    /// BigTIFF is kept, and taken whenever a bound of the length exceeds [`CLASSIC_LIMIT_BYTES`].
    ///
    /// # Errors
    /// Sizes outside the range.
    pub fn new(
        input: &Header,
        [width_px, height_px]: [u32; 2],
        options: &PlanOptions,
    ) -> Result<Self, PlanError> {
        for (tag, px) in [(Tag::WIDTH, width_px), (Tag::LENGTH, height_px)] {
            if px == 0 || px > SIDE_LIMIT_PX {
                return Err(PlanError::Size { tag, px });
            }
        }
        let compression = options.compression.unwrap_or(input.compression);
        let asked = options
            .compression
            .is_some_and(|it| it != input.compression);
        let mut plan = Self {
            width_px,
            height_px,
            samples: input.samples,
            bits: input.bits,
            photometric: input.photometric,
            extra_samples: input.extra_samples.clone(),
            compression,
            predictor: compression_predicts(compression) && (asked || input.predictor),
            chunks: options.chunks.unwrap_or(input.chunks),
            big: options.big || input.big,
        };
        plan.complete_extra_samples();
        plan.fit_chunks(options)?;
        plan.big |= plan.bound_bytes(0) > CLASSIC_LIMIT_BYTES;
        Ok(plan)
    }

    /// Returns the strips or tiles.
    #[must_use]
    pub fn chunks(&self) -> Chunks {
        self.chunks
    }

    /// Returns the compression.
    #[must_use]
    pub fn compression(&self) -> Compression {
        self.compression
    }

    /// Returns whether it is a BigTIFF.
    #[must_use]
    pub fn is_big(&self) -> bool {
        self.big
    }

    /// Returns width and height in pixels.
    #[must_use]
    pub fn size_px(&self) -> [u32; 2] {
        [self.width_px, self.height_px]
    }

    /// Takes BigTIFF where the tags or further pages make the file too long for the classic one.
    #[must_use]
    pub fn with_bytes_beside(mut self, bytes: u64) -> Self {
        self.big |= self.bound_bytes(bytes) > CLASSIC_LIMIT_BYTES;
        self
    }

    /// Returns a bound of the file's length, with so many bytes beside the pixels and their tags.
    #[must_use]
    pub fn bound_bytes(&self, beside: u64) -> u64 {
        let chunk = self.chunk_bytes();
        // Longest output of the codecs for what cannot be compressed, generously: Deflate 9 bits a
        // byte in fixed codes, LZW 12, PackBits 1 byte of 128, zstd 3 bytes of a block.
        let bound = match self.compression {
            Compression::None => chunk,
            Compression::PackBits => chunk + chunk / 64 + u64::from(self.height_px),
            Compression::Deflate => chunk + chunk / 8,
            Compression::Lzw => chunk + chunk / 2,
            Compression::Zstd => chunk + chunk / 128,
        };
        let places = 16;
        let codec = 512;
        let tags = 4096;
        self.chunk_count() * (bound + codec + places) + tags + beside
    }

    pub(crate) fn row_samples(&self) -> usize {
        crate::header::pixels(self.width_px) * usize::from(self.samples)
    }

    /// Returns columns and rows of a chunk.
    pub(crate) fn chunk_px(&self) -> [u32; 2] {
        match self.chunks {
            Chunks::Strips { rows } => [self.width_px, rows],
            Chunks::Tiles {
                width_px,
                height_px,
            } => [width_px, height_px],
        }
    }

    pub(crate) fn chunk_count(&self) -> u64 {
        let [width, height] = self.chunk_px();
        u64::from(self.width_px.div_ceil(width)) * u64::from(self.height_px.div_ceil(height))
    }

    fn chunk_bytes(&self) -> u64 {
        let [width, height] = self.chunk_px();
        u64::from(width) * u64::from(height) * u64::from(self.samples) * u64::from(self.bits / 8)
    }

    /// Returns the bytes of a row of tiles, of the part within the frame; 0 for strips.
    fn tile_row_bytes(&self) -> u64 {
        match self.chunks {
            Chunks::Strips { .. } => 0,
            Chunks::Tiles { height_px, .. } => {
                let row = self.row_samples() as u64 * u64::from(self.bits / 8);
                row * u64::from(height_px.min(self.height_px))
            }
        }
    }

    /// Samples beyond the photometric interpretation must be named (TIFF 6.0, page 31).
    fn complete_extra_samples(&mut self) {
        let own = if self.photometric == 2 { 3 } else { 1 };
        let extra = usize::from(self.samples).saturating_sub(own);
        self.extra_samples.resize(extra, 0);
    }

    fn fit_chunks(&mut self, options: &PlanOptions) -> Result<(), PlanError> {
        match &mut self.chunks {
            Chunks::Strips { rows: 0 } => return Err(PlanError::NoRows),
            Chunks::Strips { rows } => *rows = (*rows).min(self.height_px),
            Chunks::Tiles {
                width_px,
                height_px,
            } if options.chunks.is_some() => {
                for (tag, px) in [(Tag::TILE_WIDTH, *width_px), (Tag::TILE_LENGTH, *height_px)] {
                    if px == 0 || px > 8192 || px % 16 != 0 {
                        return Err(PlanError::Tile { tag, px });
                    }
                }
            }
            Chunks::Tiles {
                width_px,
                height_px,
            } => {
                for px in [width_px, height_px] {
                    *px = px.next_multiple_of(16);
                }
            }
        }
        let (bytes, limit) = (self.chunk_bytes(), CHUNK_LIMIT_BYTES);
        // Strips pass through uncompressed; tiles that are asked for are at most 8192 px wide.
        let is_bounded = options.chunks.is_some() || matches!(self.chunks, Chunks::Strips { .. });
        let is_bounded = self.compression == Compression::None && is_bounded;
        let is_held = options.chunks.is_none() && self.tile_row_bytes() > TILE_ROW_LIMIT_BYTES;
        if !is_held && (bytes <= limit || is_bounded) {
            return Ok(());
        }
        if options.chunks.is_some() {
            return Err(PlanError::ChunkTooLarge { bytes, limit });
        }
        self.chunks = Chunks::Strips {
            rows: SHORT_STRIP_ROWS.min(self.height_px),
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{CHUNK_LIMIT_BYTES, CLASSIC_LIMIT_BYTES, SHORT_STRIP_ROWS};
    use crate::chunk_reader::AT_ONCE_BYTES;
    use crate::container::TAGS_LIMIT_BYTES;
    use crate::header::SIDE_LIMIT_PX;

    #[test]
    fn limits_are_those_of_the_document() {
        let document = include_str!("../../../docs/tiff.md").replace('\n', " ");
        for said in [
            format!("sides of more than {SIDE_LIMIT_PX} pixels"),
            format!("tags of more than {} MiB together", TAGS_LIMIT_BYTES >> 20),
            format!("one strip of zstd up to {} MiB", AT_ONCE_BYTES >> 20),
            format!(
                "a row of tiles of up to {} MiB",
                crate::frame_reader::TILES_HELD_BYTES >> 20
            ),
            format!(
                "row of tiles holds more than {} MiB",
                super::TILE_ROW_LIMIT_BYTES >> 20
            ),
            format!(
                "whose strips or tiles hold more than {} MiB gets strips of {SHORT_STRIP_ROWS} rows",
                CHUNK_LIMIT_BYTES >> 20
            ),
        ] {
            assert!(document.contains(&said), "{said}");
        }
        assert_eq!(CLASSIC_LIMIT_BYTES, (4 << 30) - (64 << 10));
    }
}
