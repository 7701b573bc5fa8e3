//! Output file: directories of the frame and of its mask.

use std::fmt;
use std::io::{Seek, Write};

use tiff::Directory;
use tiff::encoder::{DirectoryEncoder, TiffEncoder, TiffKind, TiffKindBig, TiffKindStandard};
use tiff::tags::Type;

use crate::chunk_encoder::Piece;
use crate::container::{Entries, Value};
use crate::frame_plan::FramePlan;
use crate::header::{Chunks, Compression};
use crate::mask::{MASK_STRIP_ROWS, Mask};
use crate::output_tags::OutputTags;
use crate::tag::Tag;
use crate::write_error::WriteError;

/// A TIFF that is being written: its frame first ([`TiffFile::frame`]), then its mask.
///
/// The byte order is the machine's, whatever the input's: samples are then written as they are, and
/// on all machines that the program is built for the bytes are the same.
pub struct TiffFile<W: Write + Seek>(Encoder<W>);

enum Encoder<W: Write + Seek> {
    Classic(TiffEncoder<W, TiffKindStandard>),
    Big(TiffEncoder<W, TiffKindBig>),
}

/// A frame that is being written.
pub struct FrameWriter<'a, W: Write + Seek> {
    directory: PageDirectory<'a, W>,
    plan: FramePlan,
    offsets: Vec<u64>,
    lengths: Vec<u64>,
    /// Bytes of the strip or tile that has begun.
    begun_bytes: Option<u64>,
}

enum PageDirectory<'a, W: Write + Seek> {
    Classic(DirectoryEncoder<'a, W, TiffKindStandard>),
    Big(DirectoryEncoder<'a, W, TiffKindBig>),
}

impl<W: Write + Seek> TiffFile<W> {
    /// Writes the first bytes of a file.
    ///
    /// # Errors
    /// The operating system did not take the bytes.
    pub fn new(out: W, plan: &FramePlan) -> Result<Self, WriteError> {
        Ok(Self(if plan.big {
            Encoder::Big(TiffEncoder::new_big(out)?)
        } else {
            Encoder::Classic(TiffEncoder::new(out)?)
        }))
    }

    /// Begins the frame: writes its tags and the directories that they point to.
    ///
    /// # Errors
    /// The operating system did not take the bytes.
    pub fn frame(
        &mut self,
        plan: &FramePlan,
        tags: &OutputTags,
    ) -> Result<FrameWriter<'_, W>, WriteError> {
        let mut exif = tags.exif.clone();
        if !tags.interop.is_empty() {
            exif.insert(Tag::INTEROP, self.directory(&tags.interop)?);
        }
        let mut pointers = Entries::new();
        for (tag, entries) in [(Tag::EXIF, &exif), (Tag::GPS, &tags.gps)] {
            if !entries.is_empty() {
                pointers.insert(tag, self.directory(entries)?);
            }
        }
        let mut directory = self.page()?;
        for (tag, value) in tags.tags.iter().chain(&pointers) {
            directory.value(*tag, value)?;
        }
        let [width, height] = plan.chunk_px();
        let samples = usize::from(plan.samples);
        directory.longs(Tag::WIDTH, &[plan.width_px])?;
        directory.longs(Tag::LENGTH, &[plan.height_px])?;
        directory.shorts(Tag::BITS, &vec![plan.bits; samples])?;
        directory.shorts(Tag::COMPRESSION, &[plan.compression.number()])?;
        directory.shorts(Tag::PHOTOMETRIC, &[plan.photometric])?;
        directory.shorts(Tag::ORIENTATION, &[1])?;
        directory.shorts(Tag::SAMPLES, &[plan.samples])?;
        directory.shorts(Tag::PLANAR, &[1])?;
        if plan.predictor {
            directory.shorts(Tag::PREDICTOR, &[2])?;
        }
        if !plan.extra_samples.is_empty() {
            directory.shorts(Tag::EXTRA_SAMPLES, &plan.extra_samples)?;
        }
        directory.shorts(Tag::SAMPLE_FORMAT, &vec![1; samples])?;
        match plan.chunks {
            Chunks::Strips { rows } => directory.longs(Tag::ROWS_PER_STRIP, &[rows])?,
            Chunks::Tiles { .. } => {
                directory.longs(Tag::TILE_WIDTH, &[width])?;
                directory.longs(Tag::TILE_LENGTH, &[height])?;
            }
        }
        Ok(FrameWriter {
            directory,
            plan: plan.clone(),
            offsets: Vec::new(),
            lengths: Vec::new(),
            begun_bytes: None,
        })
    }

    /// Writes the mask as a page of its own: `NewSubfileType` 4, `PackBits`.
    ///
    /// # Errors
    /// Rows of the mask are missing, or the operating system did not take the bytes.
    pub fn mask(&mut self, mask: &Mask) -> Result<(), WriteError> {
        let strips = mask.height_px.div_ceil(MASK_STRIP_ROWS);
        if !mask.is_complete() {
            let (written, expected) = (mask.strips.len() as u64, u64::from(strips));
            return Err(WriteError::Unfinished { written, expected });
        }
        let mut page = self.page()?;
        let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
        for strip in &mask.strips {
            offsets.push(page.data(strip)?);
            lengths.push(strip.len() as u64);
        }
        page.longs(Tag::SUBFILE_TYPE, &[4])?;
        page.longs(Tag::WIDTH, &[mask.width_px])?;
        page.longs(Tag::LENGTH, &[mask.height_px])?;
        page.shorts(Tag::BITS, &[1])?;
        page.shorts(Tag::COMPRESSION, &[Compression::PackBits.number()])?;
        page.shorts(Tag::PHOTOMETRIC, &[4])?;
        page.shorts(Tag::SAMPLES, &[1])?;
        page.longs(Tag::ROWS_PER_STRIP, &[MASK_STRIP_ROWS.min(mask.height_px)])?;
        page.shorts(Tag::PLANAR, &[1])?;
        page.places(Tag::STRIP_OFFSETS, &offsets)?;
        page.places(Tag::STRIP_BYTES, &lengths)?;
        page.finish()
    }

    /// Writes a directory besides the pages, and returns its offset as a value.
    fn directory(&mut self, entries: &Entries) -> Result<Value, WriteError> {
        Ok(match &mut self.0 {
            Encoder::Classic(encoder) => {
                let offset = write_entries(encoder.extra_directory()?, entries)?;
                let offset = u32::try_from(offset).map_err(|_| WriteError::TooLong)?;
                Value {
                    value_type: 4,
                    bytes: offset.to_ne_bytes().to_vec(),
                }
            }
            Encoder::Big(encoder) => Value {
                value_type: 18,
                bytes: write_entries(encoder.extra_directory()?, entries)?
                    .to_ne_bytes()
                    .to_vec(),
            },
        })
    }

    fn page(&mut self) -> Result<PageDirectory<'_, W>, WriteError> {
        Ok(match &mut self.0 {
            Encoder::Classic(encoder) => PageDirectory::Classic(encoder.image_directory()?),
            Encoder::Big(encoder) => PageDirectory::Big(encoder.image_directory()?),
        })
    }
}

impl<W: Write + Seek> FrameWriter<'_, W> {
    /// Writes the next bytes of a strip or tile.
    ///
    /// # Errors
    /// The operating system did not take the bytes.
    pub fn write(&mut self, piece: Piece<'_>) -> Result<(), WriteError> {
        let offset = self.directory.data(piece.bytes)?;
        let length = piece.bytes.len() as u64;
        let before = self.begun_bytes.unwrap_or_else(|| {
            self.offsets.push(offset);
            0
        });
        self.begun_bytes = Some(before + length);
        if piece.ends {
            self.lengths.push(before + length);
            self.begun_bytes = None;
        }
        Ok(())
    }

    /// Writes the directory.
    ///
    /// # Errors
    /// Strips or tiles are missing, or the operating system did not take the bytes.
    pub fn finish(mut self) -> Result<(), WriteError> {
        let (written, expected) = (self.lengths.len() as u64, self.plan.chunk_count());
        if written != expected || self.offsets.len() != self.lengths.len() {
            return Err(WriteError::Unfinished { written, expected });
        }
        let (offsets, lengths) = match self.plan.chunks {
            Chunks::Strips { .. } => (Tag::STRIP_OFFSETS, Tag::STRIP_BYTES),
            Chunks::Tiles { .. } => (Tag::TILE_OFFSETS, Tag::TILE_BYTES),
        };
        self.directory.places(offsets, &self.offsets)?;
        self.directory.places(lengths, &self.lengths)?;
        self.directory.finish()
    }
}

impl<W: Write + Seek> PageDirectory<'_, W> {
    fn data(&mut self, bytes: &[u8]) -> Result<u64, WriteError> {
        Ok(match self {
            Self::Classic(directory) => directory.write_data(bytes)?,
            Self::Big(directory) => directory.write_data(bytes)?,
        })
    }

    fn value(&mut self, tag: Tag, value: &Value) -> Result<(), WriteError> {
        match self {
            Self::Classic(directory) => write_value(directory, tag, value),
            Self::Big(directory) => write_value(directory, tag, value),
        }
    }

    fn shorts(&mut self, tag: Tag, numbers: &[u16]) -> Result<(), WriteError> {
        let bytes = numbers.iter().flat_map(|number| number.to_ne_bytes());
        let value = Value {
            value_type: 3,
            bytes: bytes.collect(),
        };
        self.value(tag, &value)
    }

    fn longs(&mut self, tag: Tag, numbers: &[u32]) -> Result<(), WriteError> {
        let bytes = numbers.iter().flat_map(|number| number.to_ne_bytes());
        let value = Value {
            value_type: 4,
            bytes: bytes.collect(),
        };
        self.value(tag, &value)
    }

    /// Writes offsets or lengths: 32 bits in a classic file, 64 in a big one.
    fn places(&mut self, tag: Tag, numbers: &[u64]) -> Result<(), WriteError> {
        if let Self::Big(directory) = self {
            let bytes = numbers.iter().flat_map(|number| number.to_ne_bytes());
            let value = Value {
                value_type: 16,
                bytes: bytes.collect(),
            };
            return write_value(directory, tag, &value);
        }
        let numbers: Result<Vec<_>, _> = numbers.iter().map(|it| u32::try_from(*it)).collect();
        self.longs(tag, &numbers.map_err(|_| WriteError::TooLong)?)
    }

    fn finish(self) -> Result<(), WriteError> {
        match self {
            Self::Classic(mut directory) => {
                align(&mut directory)?;
                directory.finish()?;
            }
            Self::Big(mut directory) => {
                align(&mut directory)?;
                directory.finish()?;
            }
        }
        Ok(())
    }
}

fn write_entries<W: Write + Seek, K: TiffKind>(
    mut directory: DirectoryEncoder<'_, W, K>,
    entries: &Entries,
) -> Result<u64, WriteError> {
    for (tag, value) in entries {
        write_value(&mut directory, *tag, value)?;
    }
    align(&mut directory)?;
    Ok(directory.finish_with_offsets()?.pointer.0)
}

/// Values and directories begin at even offsets (TIFF 6.0, page 13); strips of odd length stand
/// before them.
fn align<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<'_, W, K>,
) -> Result<(), WriteError> {
    let nothing: &[u8] = &[];
    if directory.write_data(nothing)? % 2 == 1 {
        directory.write_data(0_u8)?;
    }
    Ok(())
}

fn write_value<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<'_, W, K>,
    tag: Tag,
    value: &Value,
) -> Result<(), WriteError> {
    let value_type = Type::from_u16(value.value_type)
        .ok_or_else(|| WriteError::Encode(format!("{tag}: type {}", value.value_type)))?;
    align(directory)?;
    let entry = directory.write_entry_bytes(value_type, &value.bytes)?;
    let mut entries = Directory::empty();
    entries.extend([(tiff::tags::Tag::from_u16_exhaustive(tag.0), entry)]);
    directory.extend_from(&entries);
    Ok(())
}

impl<W: Write + Seek> fmt::Debug for TiffFile<W> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("TiffFile").finish_non_exhaustive()
    }
}

impl<W: Write + Seek> fmt::Debug for FrameWriter<'_, W> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("FrameWriter")
            .field("plan", &self.plan)
            .field("chunks", &self.lengths.len())
            .finish_non_exhaustive()
    }
}
