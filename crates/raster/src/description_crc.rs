//! CRC-32 of all of a frame but its pixels.

use crc32fast::Hasher;

use crate::container::Entries;
use crate::frame_reader::FrameReader;
use crate::header::{Chunks, Header};

impl FrameReader {
    /// Returns a CRC-32 (IEEE 802.3) of what an output takes from its input besides the pixels:
    /// their layout, and the tags with their values. It is the same for files of either byte order.
    #[must_use]
    pub fn description_crc(&self) -> u32 {
        let mut crc = Hasher::new();
        add_header(&mut crc, self.header());
        let metadata = self.metadata();
        for entries in [
            &metadata.tags,
            &metadata.exif,
            &metadata.interop,
            &metadata.gps,
        ] {
            add_entries(&mut crc, entries);
        }
        crc.finalize()
    }
}

fn add_header(crc: &mut Hasher, header: &Header) {
    let (kind, [columns, rows]) = match header.chunks {
        Chunks::Strips { rows } => (0, [header.width_px, rows]),
        Chunks::Tiles {
            width_px,
            height_px,
        } => (1, [width_px, height_px]),
    };
    for side in [header.width_px, header.height_px, columns, rows] {
        crc.update(&side.to_le_bytes());
    }
    let numbers = [
        kind,
        header.samples,
        header.bits,
        header.photometric,
        header.compression.number(),
        u16::from(header.predictor),
        u16::from(header.planar),
        u16::from(header.big),
    ];
    for number in numbers.iter().chain(&header.extra_samples) {
        crc.update(&number.to_le_bytes());
    }
}

fn add_entries(crc: &mut Hasher, entries: &Entries) {
    crc.update(&(entries.len() as u64).to_le_bytes());
    for (tag, value) in entries {
        crc.update(&tag.0.to_le_bytes());
        crc.update(&value.value_type.to_le_bytes());
        crc.update(&(value.bytes.len() as u64).to_le_bytes());
        crc.update(&value.bytes);
    }
}
