//! Rows of a frame, read in order.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use tiff::tags::ByteOrder;

use crate::chunk_reader::{AtOnce, ChunkBytes, ChunkReader};
use crate::chunk_table::ChunkTable;
use crate::container::Container;
use crate::header::{Chunks, Header, pixels};
use crate::metadata::Metadata;
use crate::read_error::ReadError;
use crate::sample::{Sample, integrate, typed_buffer};
use crate::source::{Segment, Source};

/// Longest row of tiles that is decoded as a whole; the tiles of a longer one are decoded side by
/// side, row by row.
pub const TILES_HELD_BYTES: u64 = 64 << 20;

/// A frame of a TIFF whose rows are read in order, with bounded memory: strips row by row whatever
/// their length, tiles one row of tiles at a time, or row by row if that is longer than
/// [`TILES_HELD_BYTES`] or what [`Self::holding`] says. It may be moved to the thread that decodes.
///
/// Of several pages, the first of full resolution is the frame ([`Metadata::dropped`] names the
/// others).
pub struct FrameReader {
    container: Container,
    header: Header,
    table: ChunkTable,
    metadata: Metadata,
    next_row: u32,
    /// Decoders of the open strips, one per plane, or of the tiles that are decoded side by side,
    /// and their numbers.
    open: Vec<(usize, ChunkReader)>,
    /// Rows of tiles, or one row of a plane; `u16` for the alignment of both kinds of samples.
    buffer: Vec<u16>,
    plane_row: Vec<u16>,
    at_once: AtOnce,
    held_bytes: u64,
}

impl FrameReader {
    /// Opens a file.
    ///
    /// # Errors
    /// The reason why it is not read as a frame.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let doing = "open";
        let file = File::open(path).map_err(|source| ReadError::Io { doing, source })?;
        let metadata = file.metadata();
        if metadata.is_ok_and(|metadata| metadata.is_dir()) {
            return Err(ReadError::Folder);
        }
        Self::new(Arc::new(file))
    }

    /// Reads the directories of a file.
    ///
    /// # Errors
    /// The reason why it is not read as a frame.
    pub fn new(source: Arc<dyn Source>) -> Result<Self, ReadError> {
        let container = Container::open(source)?;
        let pages = container.directories()?;
        let (page, metadata) = Metadata::read(&container, pages)?;
        let header = Header::read(&container, &page)?;
        let table = ChunkTable::read(&container, &page, &header)?;
        Ok(Self {
            container,
            header,
            table,
            metadata,
            next_row: 0,
            open: Vec::new(),
            buffer: Vec::new(),
            plane_row: Vec::new(),
            at_once: AtOnce::default(),
            held_bytes: TILES_HELD_BYTES,
        })
    }

    /// Selects the longest row of tiles that is decoded as a whole, decoded bytes. To be called
    /// before rows are read.
    #[must_use]
    pub fn holding(mut self, tiles_bytes: u64) -> Self {
        self.held_bytes = tiles_bytes;
        self
    }

    /// Returns the facts of the pixels.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Returns all other tags.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Returns the row that is read next; the height, once all are read.
    #[must_use]
    pub fn next_row(&self) -> u32 {
        self.next_row
    }

    /// Fills a buffer with the next rows, interleaved samples in the machine's byte order, and
    /// returns how many rows were read: as many as the buffer holds, fewer at the end of the frame.
    ///
    /// # Errors
    /// The file holds other samples, is cut off, or its pixels cannot be decoded. Nothing may be
    /// read after an error.
    pub fn read_rows<S: Sample>(&mut self, rows: &mut [S]) -> Result<u32, ReadError> {
        if S::BITS != self.header.bits {
            return Err(ReadError::SampleType {
                bits: self.header.bits,
                asked: S::BITS,
            });
        }
        let row_samples = self.header.row_samples();
        let first_row = self.next_row;
        let wanted = u32::try_from(rows.len() / row_samples).unwrap_or(u32::MAX);
        let end = first_row.saturating_add(wanted).min(self.header.height_px);
        let mut rest = rows;
        while self.next_row < end {
            let chunk_rows = self.table.height_px;
            let inside = self.next_row % chunk_rows;
            let count = (end - self.next_row).min(chunk_rows - inside);
            let length = pixels(count) * row_samples;
            let (now, later) = rest.split_at_mut_checked(length).unwrap_or_default();
            match self.header.chunks {
                Chunks::Strips { .. } => self.strip_rows(inside, now)?,
                Chunks::Tiles { .. } if self.has_long_tiles() => {
                    self.long_tile_rows(inside, now)?;
                }
                Chunks::Tiles { .. } => self.tile_rows(inside, now)?,
            }
            self.next_row += count;
            rest = later;
        }
        Ok(self.next_row - first_row)
    }

    /// Reads rows of one row of strips; `inside` is the first row within it.
    fn strip_rows<S: Sample>(&mut self, inside: u32, rows: &mut [S]) -> Result<(), ReadError> {
        let down = pixels(self.next_row / self.table.height_px);
        if inside == 0 {
            self.open_chunks(down, 1)?;
        }
        let row = self.next_row;
        let samples = usize::from(self.header.samples);
        let repair = Repair::of(&self.header);
        if self.header.planar {
            let width = pixels(self.header.width_px);
            for pixels in rows.chunks_exact_mut(width * samples) {
                for (plane, (index, reader)) in self.open.iter_mut().enumerate() {
                    let plane_row = typed_buffer::<S>(&mut self.plane_row, width);
                    read(reader, plane_row).map_err(|error| chunk_error(*index, row, &error))?;
                    repair.row(plane_row, 1);
                    scatter(pixels, plane_row, plane, samples);
                }
            }
        } else if let Some((index, reader)) = self.open.first_mut() {
            read(reader, rows).map_err(|error| chunk_error(*index, row, &error))?;
            for row in rows.chunks_exact_mut(self.header.row_samples()) {
                repair.row(row, samples);
            }
        }
        let end = pixels(self.table.rows(&self.header, down));
        self.finish_at(
            end,
            inside as usize + rows.len() / self.header.row_samples(),
        )
    }

    /// Opens the strips or tiles of all planes at a row of them.
    fn open_chunks(&mut self, down: usize, across: usize) -> Result<(), ReadError> {
        for (_, reader) in self.open.drain(..) {
            reader.recycle(&mut self.at_once);
        }
        let planes = if self.header.planar {
            self.header.samples
        } else {
            1
        };
        for plane in 0..usize::from(planes) {
            for column in 0..across {
                let index = self.table.index(plane, down, column);
                let reader = self.chunk(index)?;
                self.open.push((index, reader));
            }
        }
        Ok(())
    }

    /// Reads the ends of the open strips or tiles once all their rows have been read.
    fn finish_at(&mut self, end: usize, read_rows: usize) -> Result<(), ReadError> {
        if read_rows == end {
            for (index, reader) in &mut self.open {
                let end = reader.finish();
                end.map_err(|error| chunk_error(*index, self.next_row, &error))?;
            }
        }
        Ok(())
    }

    /// Returns true if the tiles are decoded side by side, row by row.
    fn has_long_tiles(&self) -> bool {
        let rows = u64::from(self.table.height_px.min(self.header.height_px));
        let row = self.header.row_samples() as u64 * self.header.sample_bytes() as u64;
        matches!(self.header.chunks, Chunks::Tiles { .. }) && row * rows > self.held_bytes
    }

    /// Reads rows of one row of tiles, all of which are open.
    fn long_tile_rows<S: Sample>(&mut self, inside: u32, rows: &mut [S]) -> Result<(), ReadError> {
        let down = pixels(self.next_row / self.table.height_px);
        let across = self.table.across;
        if inside == 0 {
            self.open_chunks(down, across)?;
        }
        let row_samples = self.header.row_samples();
        let parts = TileParts::of(&self.header, self.table.width_px);
        let row = self.next_row;
        for row_pixels in rows.chunks_exact_mut(row_samples) {
            for (number, (index, reader)) in self.open.iter_mut().enumerate() {
                let (plane, column) = (number / across, number % across);
                parts
                    .read(reader, row_pixels, [plane, column], &mut self.plane_row)
                    .map_err(|error| chunk_error(*index, row, &error))?;
            }
        }
        // The rows of the last tiles that fill them up are not read.
        let read_rows = inside as usize + rows.len() / row_samples;
        self.finish_at(pixels(self.table.height_px), read_rows)
    }

    /// Copies rows of one row of tiles, which is decoded as its first row is read.
    fn tile_rows<S: Sample>(&mut self, inside: u32, rows: &mut [S]) -> Result<(), ReadError> {
        let down = pixels(self.next_row / self.table.height_px);
        let row_samples = self.header.row_samples();
        let held = pixels(self.table.rows(&self.header, down)) * row_samples;
        if inside == 0 {
            let mut buffer = std::mem::take(&mut self.buffer);
            self.decode_tiles(down, typed_buffer::<S>(&mut buffer, held))?;
            self.buffer = buffer;
        }
        let buffer = typed_buffer::<S>(&mut self.buffer, held);
        let first = pixels(inside) * row_samples;
        let from = buffer.get(first..).unwrap_or_default();
        for (to, from) in rows.iter_mut().zip(from) {
            *to = *from;
        }
        Ok(())
    }

    /// Decodes a row of tiles.
    fn decode_tiles<S: Sample>(&mut self, down: usize, rows: &mut [S]) -> Result<(), ReadError> {
        let parts = TileParts::of(&self.header, self.table.width_px);
        let planes = if self.header.planar {
            usize::from(self.header.samples)
        } else {
            1
        };
        let row = self.next_row;
        let whole = rows.len() == pixels(self.table.height_px) * self.header.row_samples();
        let mut tile_row = std::mem::take(&mut self.plane_row);
        for plane in 0..planes {
            for column in 0..self.table.across {
                let index = self.table.index(plane, down, column);
                let mut reader = self.chunk(index)?;
                let failed = |error| chunk_error(index, row, &error);
                for row_pixels in rows.chunks_exact_mut(self.header.row_samples()) {
                    parts
                        .read(&mut reader, row_pixels, [plane, column], &mut tile_row)
                        .map_err(failed)?;
                }
                if whole {
                    reader.finish().map_err(failed)?;
                }
                reader.recycle(&mut self.at_once);
            }
        }
        self.plane_row = tile_row;
        Ok(())
    }

    /// Opens a strip or tile.
    fn chunk(&mut self, index: usize) -> Result<ChunkReader, ReadError> {
        let (offset, compressed) = self.table.place(index);
        let segment = Segment::new(Arc::clone(&self.container.source), offset, compressed);
        let decoded = self.table.decoded_bytes(&self.header, index);
        let samples = if self.header.planar {
            1
        } else {
            self.header.samples
        };
        let row = pixels(self.table.width_px) * usize::from(samples) * self.header.sample_bytes();
        let lengths = ChunkBytes {
            compressed,
            decoded,
            row,
            streams: self.has_long_tiles(),
        };
        ChunkReader::open(self.header.compression, segment, lengths, &mut self.at_once)
            .map_err(|error| chunk_error(index, self.next_row, &error))
    }
}

impl fmt::Debug for FrameReader {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("FrameReader")
            .field("header", &self.header)
            .field("next_row", &self.next_row)
            .finish_non_exhaustive()
    }
}

/// The steps between decoded bytes and samples.
#[derive(Clone, Copy)]
struct Repair {
    swap: bool,
    predictor: bool,
}

impl Repair {
    fn of(header: &Header) -> Self {
        Self {
            swap: header.bits > 8 && header.byte_order != ByteOrder::native(),
            predictor: header.predictor,
        }
    }

    fn row<S: Sample>(self, row: &mut [S], samples: usize) {
        if self.swap {
            for sample in row.iter_mut() {
                *sample = sample.swapped();
            }
        }
        if self.predictor {
            integrate(row, samples);
        }
    }
}

/// Parts of a frame's rows that lie in tiles.
#[derive(Clone, Copy)]
struct TileParts {
    samples: usize,
    planar: bool,
    width: usize,
    repair: Repair,
}

impl TileParts {
    fn of(header: &Header, tile_width_px: u32) -> Self {
        Self {
            samples: usize::from(header.samples),
            planar: header.planar,
            width: pixels(tile_width_px),
            repair: Repair::of(header),
        }
    }

    /// Reads the next row of a tile into a row of the frame; the tile lies in a plane and a column
    /// of tiles.
    fn read<S: Sample>(
        self,
        reader: &mut ChunkReader,
        row: &mut [S],
        [plane, column]: [usize; 2],
        buffer: &mut Vec<u16>,
    ) -> io::Result<()> {
        let samples = self.samples;
        let pixels = row
            .get_mut(column * self.width * samples..)
            .unwrap_or_default();
        if self.planar {
            let tile = typed_buffer::<S>(buffer, self.width);
            read(reader, tile)?;
            self.repair.row(tile, 1);
            scatter(pixels, tile, plane, samples);
            return Ok(());
        }
        // The columns of the frame, then those that fill up the tile.
        let tile = typed_buffer::<S>(buffer, self.width * samples);
        let inside = tile.len().min(pixels.len());
        let (pixels, _) = pixels.split_at_mut_checked(inside).unwrap_or_default();
        let (_, beyond) = tile.split_at_mut_checked(inside).unwrap_or_default();
        read(reader, pixels)?;
        self.repair.row(pixels, samples);
        read(reader, beyond)
    }
}

/// Puts the samples of a plane among those of the other planes.
fn scatter<S: Sample>(pixels: &mut [S], plane_row: &[S], plane: usize, samples: usize) {
    let places = pixels.iter_mut().skip(plane).step_by(samples);
    for (to, from) in places.zip(plane_row) {
        *to = *from;
    }
}

fn read<S: Sample>(reader: &mut ChunkReader, samples: &mut [S]) -> io::Result<()> {
    reader.read_exact(bytemuck::cast_slice_mut(samples))
}

/// An error of the operating system is no fault of the file.
fn chunk_error(index: usize, row: u32, error: &io::Error) -> ReadError {
    if let Some(code) = error.raw_os_error() {
        return ReadError::Io {
            doing: "read",
            source: io::Error::from_raw_os_error(code),
        };
    }
    let reason = if error.kind() == io::ErrorKind::UnexpectedEof {
        "its data end before its last row".to_owned()
    } else {
        error.to_string()
    };
    ReadError::Chunk { index, row, reason }
}

#[cfg(test)]
mod tests {
    use super::FrameReader;
    use crate::chunk_encoder::ChunkEncoder;
    use crate::tiff_file::{FrameWriter, TiffFile};

    fn moves<T: Send>() {}

    #[test]
    fn reader_encoder_and_writer_move_to_threads() {
        moves::<FrameReader>();
        moves::<ChunkEncoder>();
        moves::<TiffFile<std::fs::File>>();
        moves::<FrameWriter<'_, std::fs::File>>();
    }
}
