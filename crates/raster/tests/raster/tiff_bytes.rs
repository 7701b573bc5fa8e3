//! TIFF files made by hand, in either byte order and container.

use std::io::Write;

use flate2::write::ZlibEncoder;
use fmc_raster::{ByteOrder, Chunks, Compression};
use tiff::encoder::compression::{CompressionAlgorithm, Lzw, Packbits};

/// An entry: tag, type and values in little-endian order.
pub(crate) type Entry = (u16, u16, Vec<u8>);

/// A file that is being put together.
pub(crate) struct TiffBytes {
    pub(crate) bytes: Vec<u8>,
    order: ByteOrder,
    big: bool,
}

/// A frame with a pattern in its pixels.
#[derive(Clone, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each doubles the number of layouts"
)]
pub(crate) struct TestFrame {
    pub(crate) order: ByteOrder,
    pub(crate) big: bool,
    pub(crate) size_px: [u32; 2],
    pub(crate) samples: u16,
    pub(crate) bits: u16,
    pub(crate) planar: bool,
    pub(crate) compression: Compression,
    pub(crate) predictor: bool,
    pub(crate) chunks: Chunks,
    /// The last strip has as many rows as the others.
    pub(crate) padded: bool,
    /// Entries that are added, or replace those of the pixels.
    pub(crate) entries: Vec<Entry>,
}

pub(crate) fn shorts(tag: u16, numbers: &[u16]) -> Entry {
    let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
    (tag, 3, bytes.collect())
}

pub(crate) fn longs(tag: u16, numbers: &[u32]) -> Entry {
    let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
    (tag, 4, bytes.collect())
}

pub(crate) fn text(tag: u16, text: &str) -> Entry {
    (tag, 2, [text.as_bytes(), &[0]].concat())
}

/// Bytes of a number of a type, after which its order is turned.
fn number_bytes(value_type: u16) -> usize {
    match value_type {
        3 | 8 => 2,
        4 | 5 | 9 | 10 | 11 | 13 => 4,
        12 | 16..=18 => 8,
        _ => 1,
    }
}

fn value_bytes(value_type: u16) -> usize {
    match value_type {
        5 | 10 => 8,
        other => number_bytes(other),
    }
}

impl TiffBytes {
    pub(crate) fn new(order: ByteOrder, big: bool) -> Self {
        let mut file = Self {
            bytes: Vec::new(),
            order,
            big,
        };
        let mark = match order {
            ByteOrder::LittleEndian => b"II",
            ByteOrder::BigEndian => b"MM",
        };
        file.bytes.extend(mark);
        if big {
            file.numbers(2, &[43, 0, 8, 0, 0, 0]);
            file.numbers(8, &[0; 8]);
        } else {
            file.numbers(2, &[42, 0]);
            file.numbers(4, &[0; 4]);
        }
        file
    }

    /// Appends little-endian numbers in the order of the file.
    fn numbers(&mut self, length: usize, little_endian: &[u8]) {
        for number in little_endian.chunks(length) {
            let mut number = number.to_vec();
            if self.order == ByteOrder::BigEndian {
                number.reverse();
            }
            self.bytes.extend(number);
        }
    }

    fn offset(&mut self, offset: usize) {
        let bytes = (offset as u64).to_le_bytes();
        let length = if self.big { 8 } else { 4 };
        self.numbers(length, &bytes[..length]);
    }

    /// Appends a directory without a next one, and returns its offset.
    pub(crate) fn directory(&mut self, entries: &[Entry]) -> usize {
        let mut entries = entries.to_vec();
        entries.sort_by_key(|(tag, _, _)| *tag);
        let inline = if self.big { 8 } else { 4 };
        let mut fields = Vec::new();
        for (_, value_type, bytes) in &entries {
            fields.push(self.bytes.len());
            if bytes.len() > inline {
                self.numbers(number_bytes(*value_type), bytes);
            }
        }
        let start = self.bytes.len();
        let count = (entries.len() as u64).to_le_bytes();
        let length = if self.big { 8 } else { 2 };
        self.numbers(length, &count[..length]);
        for ((tag, value_type, bytes), field) in entries.iter().zip(fields) {
            self.numbers(2, &tag.to_le_bytes());
            self.numbers(2, &value_type.to_le_bytes());
            self.offset(bytes.len() / value_bytes(*value_type));
            if bytes.len() > inline {
                self.offset(field);
            } else {
                self.numbers(number_bytes(*value_type), bytes);
                self.bytes
                    .extend(std::iter::repeat_n(0, inline - bytes.len()));
            }
        }
        self.offset(0);
        start
    }

    /// Appends a page: writes its offset into the header, or behind the page before.
    pub(crate) fn page(&mut self, entries: &[Entry], before: Option<usize>) -> usize {
        let start = self.directory(entries);
        // The link of a page is at its end, which is where the next page's values begin.
        let (place, length) = match (before, self.big) {
            (None, true) => (8, 8),
            (None, false) => (4, 4),
            (Some(end), true) => (end - 8, 8),
            (Some(end), false) => (end - 4, 4),
        };
        let end = self.bytes.len();
        self.offset(start);
        let link = self.bytes.split_off(end);
        self.bytes[place..place + length].copy_from_slice(&link);
        end
    }
}

impl Default for TestFrame {
    fn default() -> Self {
        Self {
            order: ByteOrder::LittleEndian,
            big: false,
            size_px: [37, 29],
            samples: 3,
            bits: 16,
            planar: false,
            compression: Compression::None,
            predictor: false,
            chunks: Chunks::Strips { rows: 8 },
            padded: false,
            entries: Vec::new(),
        }
    }
}

impl TestFrame {
    /// Returns the interleaved samples: (x (3 + k) + 5 y) 257, of 8 bits without the factor.
    pub(crate) fn pixels(&self) -> Vec<u16> {
        let [width, height] = self.size_px;
        let factor = if self.bits == 8 { 1 } else { 257 };
        let range = if self.bits == 8 { 256 } else { 65_536 };
        let mut pixels = Vec::new();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            for k in 0..u32::from(self.samples) {
                let value = (x * (3 + k) + 5 * y) * factor % range;
                pixels.push(u16::try_from(value).unwrap());
            }
        }
        pixels
    }

    /// Returns the file.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut file = TiffBytes::new(self.order, self.big);
        self.append(&mut file, None);
        file.bytes
    }

    /// Appends the frame as a page and returns its end.
    pub(crate) fn append(&self, file: &mut TiffBytes, before: Option<usize>) -> usize {
        let entries = self.pixel_entries(file);
        file.page(&entries, before)
    }

    /// Appends strips or tiles and returns the entries of the page.
    pub(crate) fn pixel_entries(&self, file: &mut TiffBytes) -> Vec<Entry> {
        let [width, height] = self.size_px;
        let [chunk_width, chunk_height] = match self.chunks {
            Chunks::Strips { rows } => [width, rows],
            Chunks::Tiles {
                width_px,
                height_px,
            } => [width_px, height_px],
        };
        let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
        let planes = if self.planar { self.samples } else { 1 };
        for plane in 0..planes {
            for top in (0..height).step_by(chunk_height as usize) {
                for left in (0..width).step_by(chunk_width as usize) {
                    let bytes = self.chunk([left, top], [chunk_width, chunk_height], plane);
                    offsets.push(u32::try_from(file.bytes.len()).unwrap());
                    lengths.push(u32::try_from(bytes.len()).unwrap());
                    file.bytes.extend(bytes);
                }
            }
        }
        let photometric = if self.samples == 1 { 1 } else { 2 };
        let mut entries = vec![
            longs(256, &[width]),
            longs(257, &[height]),
            shorts(258, &vec![self.bits; self.samples.into()]),
            shorts(259, &[self.compression.number()]),
            shorts(262, &[photometric]),
            shorts(277, &[self.samples]),
            shorts(284, &[if self.planar { 2 } else { 1 }]),
        ];
        if self.predictor {
            entries.push(shorts(317, &[2]));
        }
        if self.samples == 4 {
            entries.push(shorts(338, &[0]));
        }
        entries.extend(match self.chunks {
            Chunks::Strips { rows } => vec![
                longs(278, &[rows]),
                longs(273, &offsets),
                longs(279, &lengths),
            ],
            Chunks::Tiles { .. } => vec![
                longs(322, &[chunk_width]),
                longs(323, &[chunk_height]),
                longs(324, &offsets),
                longs(325, &lengths),
            ],
        });
        for entry in &self.entries {
            entries.retain(|(tag, _, _)| *tag != entry.0);
            entries.push(entry.clone());
        }
        entries
    }

    fn chunk(&self, [left, top]: [u32; 2], [width, rows]: [u32; 2], plane: u16) -> Vec<u8> {
        let pixels = self.pixels();
        let [frame_width, frame_height] = self.size_px.map(|px| px as usize);
        let samples = usize::from(self.samples);
        let bands: Vec<usize> = if self.planar {
            vec![plane.into()]
        } else {
            (0..samples).collect()
        };
        let is_strip = matches!(self.chunks, Chunks::Strips { .. });
        let mut encoded = Vec::new();
        let mut plain = Vec::new();
        for y in (top..top + rows).map(|y| y as usize) {
            if is_strip && !self.padded && y >= frame_height {
                break;
            }
            let mut row = Vec::new();
            for x in (left..left + width).map(|x| x as usize) {
                for band in &bands {
                    let inside = x < frame_width && y < frame_height;
                    let place = (y * frame_width + x) * samples + band;
                    row.push(if inside { pixels[place] } else { 7 });
                }
            }
            if self.predictor {
                for place in (bands.len()..row.len()).rev() {
                    row[place] = row[place].wrapping_sub(row[place - bands.len()]);
                }
            }
            let bytes: Vec<u8> = match (self.bits, self.order) {
                (8, _) => row.iter().map(|sample| (sample & 255) as u8).collect(),
                (_, ByteOrder::LittleEndian) => row.iter().flat_map(|s| s.to_le_bytes()).collect(),
                (_, ByteOrder::BigEndian) => row.iter().flat_map(|s| s.to_be_bytes()).collect(),
            };
            if self.compression == Compression::PackBits {
                Packbits.write_to(&mut encoded, &bytes).unwrap();
            }
            plain.extend(bytes);
        }
        match self.compression {
            Compression::None => plain,
            Compression::PackBits => encoded,
            Compression::Lzw => {
                Lzw.write_to(&mut encoded, &plain).unwrap();
                encoded
            }
            Compression::Deflate => {
                let mut encoder = ZlibEncoder::new(encoded, flate2::Compression::new(6));
                encoder.write_all(&plain).unwrap();
                encoder.finish().unwrap()
            }
            Compression::Zstd => zstd::bulk::compress(&plain, 3).unwrap(),
        }
    }
}
