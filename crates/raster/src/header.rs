//! Facts of a frame's pixels: size, samples and layout.

use std::fmt;

pub use tiff::tags::ByteOrder;

use crate::container::{Container, Directory, Entry};
use crate::read_error::ReadError;
use crate::tag::Tag;

/// Largest width and height, in pixels.
pub(crate) const SIDE_LIMIT_PX: u32 = 300_000;

/// Facts of a frame's pixels.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Header {
    /// Columns.
    pub width_px: u32,
    /// Rows.
    pub height_px: u32,
    /// Samples of a pixel: 1, 3 or 4.
    pub samples: u16,
    /// Bits of a sample: 8 or 16.
    pub bits: u16,
    /// Photometric interpretation: 0 white is zero, 1 black is zero, 2 RGB.
    pub photometric: u16,
    /// Meaning of the samples beyond those of the photometric interpretation (tag 338).
    pub extra_samples: Vec<u16>,
    /// Compression.
    pub compression: Compression,
    /// The samples are differences along a row (predictor 2).
    pub predictor: bool,
    /// Strips or tiles.
    pub chunks: Chunks,
    /// Each sample has strips or tiles of its own.
    pub planar: bool,
    /// Byte order of the file.
    pub byte_order: ByteOrder,
    /// The file is a BigTIFF.
    pub big: bool,
}

/// Compression of strips and tiles.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Compression {
    /// None (1).
    None,
    /// LZW (5).
    Lzw,
    /// Deflate (8 and 32946).
    Deflate,
    /// Runs of bytes (32773).
    PackBits,
    /// Zstandard (50000).
    Zstd,
}

/// Strips or tiles.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Chunks {
    /// Strips of so many rows, the last one shorter.
    Strips {
        /// Rows of a strip, at most the height.
        rows: u32,
    },
    /// Tiles, those at the right and lower edge filled up.
    Tiles {
        /// Columns of a tile.
        width_px: u32,
        /// Rows of a tile.
        height_px: u32,
    },
}

impl Compression {
    /// Returns the value of tag 259.
    #[must_use]
    pub fn number(self) -> u16 {
        match self {
            Self::None => 1,
            Self::Lzw => 5,
            Self::Deflate => 8,
            Self::PackBits => 32_773,
            Self::Zstd => 50_000,
        }
    }
}

impl fmt::Display for Compression {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::None => "none",
            Self::Lzw => "lzw",
            Self::Deflate => "deflate",
            Self::PackBits => "packbits",
            Self::Zstd => "zstd",
        })
    }
}

impl Header {
    /// Returns the samples of a row.
    #[must_use]
    pub fn row_samples(&self) -> usize {
        pixels(self.width_px) * usize::from(self.samples)
    }

    /// Returns whether one strip holds the whole frame.
    #[must_use]
    pub fn is_one_strip(&self) -> bool {
        self.height_px > 1
            && self.chunks
                == Chunks::Strips {
                    rows: self.height_px,
                }
    }

    /// Returns the bytes of a sample.
    pub(crate) fn sample_bytes(&self) -> usize {
        usize::from(self.bits / 8)
    }

    /// Reads and checks the tags of a page's pixels.
    pub(crate) fn read(container: &Container, page: &Directory) -> Result<Self, ReadError> {
        let tags = Tags { container, page };
        let side = |tag| -> Result<u32, ReadError> {
            let value = tags.number(tag)?.ok_or(ReadError::Missing { tag })?;
            let px = u32::try_from(value).unwrap_or(u32::MAX);
            let allowed = "1 to 300000";
            if px == 0 || px > SIDE_LIMIT_PX {
                return Err(ReadError::Value {
                    tag,
                    value,
                    allowed,
                });
            }
            Ok(px)
        };
        let (width_px, height_px) = (side(Tag::WIDTH)?, side(Tag::LENGTH)?);
        tags.only(Tag::FILL_ORDER, 1, &[1], "1")?;
        tags.only(
            Tag::ORIENTATION,
            1,
            &[1],
            "1 (the rows and columns as recorded)",
        )?;
        let compression = match tags.number(Tag::COMPRESSION)?.unwrap_or(1) {
            1 => Compression::None,
            5 => Compression::Lzw,
            8 | 32_946 => Compression::Deflate,
            32_773 => Compression::PackBits,
            50_000 => Compression::Zstd,
            value => {
                return Err(ReadError::Value {
                    tag: Tag::COMPRESSION,
                    value,
                    allowed: "1 (none), 5 (LZW), 8 and 32946 (Deflate), 32773 (PackBits), \
                              50000 (zstd)",
                });
            }
        };
        let samples = tags.only(Tag::SAMPLES, 1, &[1, 3, 4], "1, 3, 4")?;
        let bits = tags.same(Tag::BITS, samples, 1, &[8, 16], "8, 16 in all samples")?;
        tags.same(
            Tag::SAMPLE_FORMAT,
            samples,
            1,
            &[1, 4],
            "1 (unsigned integers)",
        )?;
        let tag = Tag::PHOTOMETRIC;
        let photometric = tags.number(tag)?.ok_or(ReadError::Missing { tag })?;
        let photometric = one_of(
            tag,
            photometric,
            &[0, 1, 2],
            "0 (white is zero), 1 (black is zero), 2 (RGB)",
        )?;
        if photometric == 2 && samples < 3 {
            return Err(ReadError::Pair {
                tag: Tag::SAMPLES,
                value: samples.into(),
                other: Tag::PHOTOMETRIC,
                other_value: 2,
                allowed: "3, 4 samples of RGB",
            });
        }
        let predictor = tags.only(
            Tag::PREDICTOR,
            1,
            &[1, 2],
            "1 (none), 2 (horizontal differences)",
        )? == 2;
        let planar = tags.only(Tag::PLANAR, 1, &[1, 2], "1 (chunky), 2 (planar)")? == 2;
        Ok(Self {
            width_px,
            height_px,
            samples,
            bits,
            photometric,
            extra_samples: tags.extra_samples(samples)?,
            compression,
            predictor: predictor && compression_predicts(compression),
            chunks: tags.chunks(height_px)?,
            planar: planar && samples > 1,
            byte_order: container.byte_order,
            big: container.big,
        })
    }
}

/// The predictor applies to LZW, Deflate and zstd alone (libtiff ignores the tag elsewhere).
pub(crate) fn compression_predicts(compression: Compression) -> bool {
    matches!(
        compression,
        Compression::Lzw | Compression::Deflate | Compression::Zstd
    )
}

/// Returns a number of pixels as a length.
pub(crate) fn pixels(px: u32) -> usize {
    usize::try_from(px).unwrap_or(usize::MAX)
}

/// The tags of a page.
pub(crate) struct Tags<'a> {
    pub(crate) container: &'a Container,
    pub(crate) page: &'a Directory,
}

impl Tags<'_> {
    /// Reads the unsigned numbers of a tag.
    pub(crate) fn numbers(&self, tag: Tag) -> Result<Option<Vec<u64>>, ReadError> {
        let Some(entry) = self.page.find(tag) else {
            return Ok(None);
        };
        let value = self.container.value(entry)?;
        let numbers = value.and_then(|value| value.unsigned());
        let numbers = numbers.ok_or_else(|| shape(entry, "unsigned integers"))?;
        Ok(Some(numbers))
    }

    /// Reads the one unsigned number of a tag.
    pub(crate) fn number(&self, tag: Tag) -> Result<Option<u64>, ReadError> {
        let Some(entry) = self.page.find(tag) else {
            return Ok(None);
        };
        if entry.count != 1 {
            return Err(shape(entry, "1 unsigned integer"));
        }
        Ok(self
            .numbers(tag)?
            .and_then(|numbers| numbers.first().copied()))
    }

    /// Reads a number that must be one of a list.
    fn only(
        &self,
        tag: Tag,
        default: u16,
        allowed: &[u16],
        said: &'static str,
    ) -> Result<u16, ReadError> {
        let value = self.number(tag)?.unwrap_or(default.into());
        one_of(tag, value, allowed, said)
    }

    /// Reads a number that comes once, or the same for every sample.
    fn same(
        &self,
        tag: Tag,
        samples: u16,
        default: u16,
        allowed: &[u16],
        said: &'static str,
    ) -> Result<u16, ReadError> {
        let Some(entry) = self.page.find(tag) else {
            return one_of(tag, default.into(), allowed, said);
        };
        if entry.count != 1 && entry.count != u64::from(samples) {
            return Err(shape(entry, &format!("1 value, or {samples}")));
        }
        let numbers = self.numbers(tag)?.unwrap_or_default();
        let first = numbers.first().copied().unwrap_or_default();
        for value in &numbers {
            one_of(tag, *value, allowed, said)?;
            if *value != first {
                return Err(ReadError::Value {
                    tag,
                    value: *value,
                    allowed: "the same for all samples",
                });
            }
        }
        one_of(tag, first, allowed, said)
    }

    fn extra_samples(&self, samples: u16) -> Result<Vec<u16>, ReadError> {
        let Some(entry) = self.page.find(Tag::EXTRA_SAMPLES) else {
            return Ok(Vec::new());
        };
        if entry.count > u64::from(samples) {
            return Err(shape(entry, &format!("up to {samples} values")));
        }
        let numbers = self.numbers(Tag::EXTRA_SAMPLES)?.unwrap_or_default();
        let said = "0, 1, 2";
        numbers
            .into_iter()
            .map(|value| one_of(Tag::EXTRA_SAMPLES, value, &[0, 1, 2], said))
            .collect()
    }

    fn chunks(&self, height_px: u32) -> Result<Chunks, ReadError> {
        let tile = |tag| -> Result<u32, ReadError> {
            let value = self.number(tag)?.ok_or(ReadError::Missing { tag })?;
            let px = u32::try_from(value).ok();
            let px = px.filter(|px| (1..=SIDE_LIMIT_PX).contains(px));
            px.ok_or(ReadError::Value {
                tag,
                value,
                allowed: "1 to 300000",
            })
        };
        if self.page.find(Tag::TILE_OFFSETS).is_some() || self.page.find(Tag::TILE_WIDTH).is_some()
        {
            return Ok(Chunks::Tiles {
                width_px: tile(Tag::TILE_WIDTH)?,
                height_px: tile(Tag::TILE_LENGTH)?,
            });
        }
        let rows = self
            .number(Tag::ROWS_PER_STRIP)?
            .unwrap_or(height_px.into());
        if rows == 0 {
            return Err(ReadError::Value {
                tag: Tag::ROWS_PER_STRIP,
                value: 0,
                allowed: "1 and more",
            });
        }
        let rows = u32::try_from(rows).unwrap_or(u32::MAX).min(height_px);
        Ok(Chunks::Strips { rows })
    }
}

fn one_of(tag: Tag, value: u64, allowed: &[u16], said: &'static str) -> Result<u16, ReadError> {
    let found = allowed.iter().find(|number| u64::from(**number) == value);
    found.copied().ok_or(ReadError::Value {
        tag,
        value,
        allowed: said,
    })
}

fn shape(entry: &Entry, allowed: &str) -> ReadError {
    ReadError::Shape {
        tag: entry.tag,
        count: entry.count,
        value_type: entry.value_type,
        allowed: allowed.to_owned(),
    }
}
