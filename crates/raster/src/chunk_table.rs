//! Places of a frame's strips or tiles in the file.

use crate::container::{Container, Directory};
use crate::header::{Chunks, Compression, Header, Tags, pixels};
use crate::read_error::ReadError;
use crate::tag::Tag;

/// Rows of tiles up to this many decoded bytes are believed whatever the file's length.
const BELIEVED_BYTES: u64 = 16 << 20;
/// Largest row of tiles: the rows that are decoded at once.
const TILES_LIMIT_BYTES: u64 = 1 << 30;

/// Places of strips or tiles: those of the first plane row by row, then those of the next.
#[derive(Clone, Debug)]
pub(crate) struct ChunkTable {
    places: Vec<(u64, u64)>,
    pub(crate) across: usize,
    per_plane: usize,
    /// Columns and rows of a chunk.
    pub(crate) width_px: u32,
    pub(crate) height_px: u32,
}

/// Largest number of strips or tiles: tiles of 16 px in four planes of 150 megapixels are 2.4
/// million.
const CHUNKS_LIMIT: u64 = 4 << 20;

impl ChunkTable {
    /// Reads the table and checks it against the file's length.
    pub(crate) fn read(
        container: &Container,
        page: &Directory,
        header: &Header,
    ) -> Result<Self, ReadError> {
        let tags = Tags { container, page };
        let (width_px, height_px, offsets, lengths) = match header.chunks {
            Chunks::Strips { rows } => {
                (header.width_px, rows, Tag::STRIP_OFFSETS, Tag::STRIP_BYTES)
            }
            Chunks::Tiles {
                width_px,
                height_px,
            } => (width_px, height_px, Tag::TILE_OFFSETS, Tag::TILE_BYTES),
        };
        let across = pixels(header.width_px.div_ceil(width_px));
        let per_plane = across * pixels(header.height_px.div_ceil(height_px));
        let planes = if header.planar { header.samples } else { 1 };
        let expected = (per_plane as u64).saturating_mul(planes.into());
        if expected > CHUNKS_LIMIT {
            return Err(ReadError::TooManyChunks {
                chunks: expected,
                limit: CHUNKS_LIMIT,
            });
        }
        let numbers = |tag| -> Result<Vec<u64>, ReadError> {
            let entry = page.find(tag).ok_or(ReadError::Missing { tag })?;
            if entry.count != expected {
                return Err(ReadError::Shape {
                    tag,
                    count: entry.count,
                    value_type: entry.value_type,
                    allowed: format!("{expected} unsigned integers"),
                });
            }
            Ok(tags.numbers(tag)?.unwrap_or_default())
        };
        let places = numbers(offsets)?.into_iter().zip(numbers(lengths)?);
        let table = Self {
            places: places.collect(),
            across,
            per_plane,
            width_px,
            height_px,
        };
        table.check(container.file_bytes, header, lengths)?;
        Ok(table)
    }

    /// Returns the number of a chunk: plane, row of chunks and column.
    pub(crate) fn index(&self, plane: usize, down: usize, column: usize) -> usize {
        plane * self.per_plane + down * self.across + column
    }

    /// Returns offset and length of a chunk.
    pub(crate) fn place(&self, index: usize) -> (u64, u64) {
        self.places.get(index).copied().unwrap_or_default()
    }

    /// Returns the rows that a row of chunks holds of the frame.
    pub(crate) fn rows(&self, header: &Header, down: usize) -> u32 {
        let first = u64::from(self.height_px) * down as u64;
        let left = u64::from(header.height_px).saturating_sub(first);
        u32::try_from(left).unwrap_or(u32::MAX).min(self.height_px)
    }

    /// Returns the decoded bytes of a chunk: tiles are filled up, the last strip is not.
    pub(crate) fn decoded_bytes(&self, header: &Header, index: usize) -> u64 {
        let down = index % self.per_plane.max(1) / self.across.max(1);
        let rows = match header.chunks {
            Chunks::Strips { .. } => self.rows(header, down),
            Chunks::Tiles { height_px, .. } => height_px,
        };
        let samples = if header.planar { 1 } else { header.samples };
        let row = u64::from(self.width_px) * u64::from(samples) * header.sample_bytes() as u64;
        row * u64::from(rows)
    }

    fn check(&self, file_bytes: u64, header: &Header, tag: Tag) -> Result<(), ReadError> {
        let ratio = largest_ratio(header.compression);
        for (index, (offset, bytes)) in self.places.iter().copied().enumerate() {
            if offset == 0 || bytes == 0 {
                return Err(ReadError::ChunkAbsent {
                    tag,
                    index,
                    offset,
                    bytes,
                });
            }
            if offset.saturating_add(bytes) > file_bytes {
                return Err(ReadError::ChunkBeyondFile {
                    tag,
                    index,
                    offset,
                    bytes,
                    file_bytes,
                });
            }
            let needed = self.decoded_bytes(header, index).div_ceil(ratio);
            if bytes < needed {
                return Err(ReadError::ChunkTooShort {
                    tag,
                    index,
                    bytes,
                    needed,
                });
            }
        }
        if let Chunks::Tiles { height_px, .. } = header.chunks {
            let row = header.row_samples() as u64 * header.sample_bytes() as u64;
            let bytes = row * u64::from(height_px.min(header.height_px));
            let file_holds = file_bytes.saturating_mul(ratio).max(BELIEVED_BYTES);
            let limit = TILES_LIMIT_BYTES.min(file_holds);
            if bytes > limit {
                return Err(ReadError::TilesTooLarge { bytes, limit });
            }
        }
        Ok(())
    }
}

/// Returns more bytes than one byte of a compression can stand for, from the longest match and its
/// shortest code (Deflate 258 bytes in 2 bits, PackBits 128 in 16, LZW a string of up to 4093 bytes
/// in 12; a run of a zstd block 128 KiB in 32).
fn largest_ratio(compression: Compression) -> u64 {
    match compression {
        Compression::None => 1,
        Compression::PackBits => 64,
        Compression::Deflate => 1032,
        Compression::Lzw => 2729,
        Compression::Zstd => 32_768,
    }
}
