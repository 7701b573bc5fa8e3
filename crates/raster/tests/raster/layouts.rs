//! Every layout is read, and written so that others read it.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use fmc_raster::{
    ByteOrder, ChunkEncoder, Chunks, Compression, FramePlan, FrameReader, Mask, PixelCrc,
    PlanOptions, Sample, TILE_ROW_LIMIT_BYTES, TagOptions, TiffFile,
};
use tiff::decoder::{Decoder, DecodingResult};

use crate::tiff_bytes::{TestFrame, TiffBytes, shorts};

const CODECS: [(Compression, bool); 8] = [
    (Compression::None, false),
    (Compression::PackBits, false),
    (Compression::Lzw, false),
    (Compression::Lzw, true),
    (Compression::Deflate, false),
    (Compression::Deflate, true),
    (Compression::Zstd, false),
    (Compression::Zstd, true),
];

/// Reads all rows in bands of so many, as 16 bits.
fn read(reader: &mut FrameReader, band_rows: usize) -> Vec<u16> {
    fn rows<S: Sample + Into<u16>>(reader: &mut FrameReader, band_rows: usize) -> Vec<u16> {
        let row_samples = reader.header().row_samples();
        let mut band = vec![S::zeroed(); band_rows * row_samples];
        let mut all = Vec::new();
        loop {
            let count = reader.read_rows(&mut band).unwrap() as usize;
            if count == 0 {
                return all;
            }
            all.extend(band[..count * row_samples].iter().map(|s| (*s).into()));
        }
    }
    match reader.header().bits {
        8 => rows::<u8>(reader, band_rows),
        _ => rows::<u16>(reader, band_rows),
    }
}

/// Writes pixels in bands of so many rows.
pub(crate) fn write(
    plan: &FramePlan,
    pixels: &[u16],
    bits: u16,
    band_samples: usize,
    mask: Option<&Mask>,
) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    let mut file = TiffFile::new(&mut out, plan).unwrap();
    let tags = fmc_raster::Metadata::default().output(&TagOptions::default());
    let mut frame = file.frame(plan, &tags).unwrap();
    let mut encoder = ChunkEncoder::new(plan).unwrap();
    for band in pixels.chunks(band_samples) {
        let mut write = |piece: fmc_raster::Piece<'_>| frame.write(piece);
        if bits == 8 {
            let band: Vec<u8> = band.iter().map(|s| u8::try_from(*s).unwrap()).collect();
            encoder.encode(&band, &mut write).unwrap();
        } else {
            encoder.encode(band, &mut write).unwrap();
        }
    }
    frame.finish().unwrap();
    if let Some(mask) = mask {
        file.mask(mask).unwrap();
    }
    out.into_inner()
}

#[test]
fn every_layout_is_read_in_bands_of_any_height() {
    let chunks = [
        Chunks::Strips { rows: 1 },
        Chunks::Strips { rows: 8 },
        Chunks::Strips { rows: 29 },
        Chunks::Tiles {
            width_px: 16,
            height_px: 16,
        },
        Chunks::Tiles {
            width_px: 64,
            height_px: 32,
        },
    ];
    let mut frames = 0;
    for (compression, predictor) in CODECS {
        for (chunks, samples, bits, planar, case) in chunks
            .into_iter()
            .flat_map(|chunks| [1, 3, 4].map(move |samples| (chunks, samples)))
            .flat_map(|(chunks, samples)| [8, 16].map(move |bits| (chunks, samples, bits)))
            .flat_map(|(c, s, b)| [false, true].map(move |planar| (c, s, b, planar)))
            .flat_map(|(c, s, b, p)| [0, 1, 2, 3].map(move |case| (c, s, b, p, case)))
        {
            let frame = TestFrame {
                order: [ByteOrder::LittleEndian, ByteOrder::BigEndian][case % 2],
                big: case > 1,
                samples,
                bits,
                planar: planar && samples > 1,
                compression,
                predictor,
                chunks,
                ..TestFrame::default()
            };
            let mut reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
            let header = reader.header();
            assert_eq!([header.width_px, header.height_px], frame.size_px);
            assert_eq!(
                (header.samples, header.bits, header.chunks),
                (samples, bits, chunks)
            );
            assert_eq!(
                (header.compression, header.predictor),
                (compression, predictor)
            );
            assert_eq!((header.byte_order, header.big), (frame.order, frame.big));
            assert_eq!(header.planar, frame.planar);
            assert_eq!(read(&mut reader, 5 + case), frame.pixels(), "{frame:?}");
            frames += 1;
            // The tiles of a row that is too long are decoded side by side.
            let is_tiled = matches!(chunks, Chunks::Tiles { .. });
            if !is_tiled || case % 3 > 0 {
                continue;
            }
            let reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
            let found = read(&mut reader.holding(0), 5 + case);
            assert_eq!(found, frame.pixels(), "{frame:?}");
        }
    }
    assert_eq!(frames, 8 * 5 * 3 * 2 * 2 * 4);
}

#[test]
fn last_strips_that_are_filled_up_are_read() {
    for (compression, predictor) in CODECS {
        let frame = TestFrame {
            compression,
            predictor,
            padded: true,
            ..TestFrame::default()
        };
        let mut reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
        assert_eq!(read(&mut reader, 7), frame.pixels(), "{compression}");
    }
}

#[test]
fn every_written_layout_is_read_by_the_crate_tiff_and_back() {
    let chunks = [
        Chunks::Strips { rows: 1 },
        Chunks::Strips { rows: 7 },
        Chunks::Strips { rows: 99 },
        Chunks::Tiles {
            width_px: 16,
            height_px: 32,
        },
        Chunks::Tiles {
            width_px: 64,
            height_px: 64,
        },
    ];
    for (compression, _) in CODECS {
        for (chunks, samples, bits, big) in chunks
            .into_iter()
            .flat_map(|chunks| [1, 3, 4].map(move |samples| (chunks, samples)))
            .flat_map(|(chunks, samples)| [8, 16].map(move |bits| (chunks, samples, bits)))
            .flat_map(|(c, s, b)| [false, true].map(move |big| (c, s, b, big)))
        {
            let frame = TestFrame {
                samples,
                bits,
                ..TestFrame::default()
            };
            let input = FrameReader::new(Arc::new(frame.bytes())).unwrap();
            let options = PlanOptions {
                compression: Some(compression),
                chunks: Some(chunks),
                big,
            };
            let plan = FramePlan::new(input.header(), frame.size_px, &options).unwrap();
            assert_eq!(plan.is_big(), big);
            let row_samples = input.header().row_samples();
            let bytes = write(&plan, &frame.pixels(), bits, 3 * row_samples, None);
            assert!(bytes.len() as u64 <= plan.bound_bytes(0));
            let bands = write(&plan, &frame.pixels(), bits, 10 * row_samples, None);
            assert!(bytes == bands, "the bytes depend on the bands");
            let mut reader = FrameReader::new(Arc::new(bytes.clone())).unwrap();
            assert_eq!(read(&mut reader, 4), frame.pixels(), "{plan:?}");
            // The crate reads three of the four samples of such a frame.
            if samples < 4 {
                let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
                let pixels = match decoder.read_image().unwrap() {
                    DecodingResult::U8(pixels) => pixels.into_iter().map(u16::from).collect(),
                    DecodingResult::U16(pixels) => pixels,
                    other => panic!("{other:?}"),
                };
                assert_eq!(pixels, frame.pixels(), "{plan:?}");
            }
        }
    }
}

#[test]
fn files_of_other_programs_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/raster/data");
    for (name, samples, bits) in [
        ("lzw-planar-big-endian.tif", 3, 16),
        ("zstd-tiles-bigtiff.tif", 4, 16),
        ("old-deflate-planar-tiles.tif", 3, 8),
        ("packbits-one-strip.tif", 1, 8),
        ("uncompressed-bigtiff-big-endian.tif", 1, 16),
    ] {
        let frame = TestFrame {
            samples,
            bits,
            ..TestFrame::default()
        };
        let mut reader = FrameReader::open(&folder.join(name)).unwrap();
        assert_eq!(reader.header().is_one_strip(), name.contains("one-strip"));
        assert_eq!(read(&mut reader, 6), frame.pixels(), "{name}");
    }
}

#[test]
fn output_is_laid_out_as_the_input_unless_asked() {
    let plan = |frame: &TestFrame, options: &PlanOptions| {
        let reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
        FramePlan::new(reader.header(), frame.size_px, options).unwrap()
    };
    let tiles = Chunks::Tiles {
        width_px: 16,
        height_px: 16,
    };
    let frame = TestFrame {
        compression: Compression::Lzw,
        predictor: true,
        planar: true,
        big: true,
        chunks: tiles,
        ..TestFrame::default()
    };
    let like = plan(&frame, &PlanOptions::default());
    assert_eq!(
        (like.compression(), like.chunks()),
        (Compression::Lzw, tiles)
    );
    assert!(like.is_big());
    let asked = plan(
        &TestFrame::default(),
        &PlanOptions {
            compression: Some(Compression::Zstd),
            chunks: Some(Chunks::Strips { rows: 1000 }),
            big: false,
        },
    );
    assert_eq!(asked.chunks(), Chunks::Strips { rows: 29 });
    assert!(!asked.is_big());

    // Rows of tiles that are too long for memory become strips.
    let tiled = |side| {
        let frame = TestFrame {
            chunks: Chunks::Tiles {
                width_px: side,
                height_px: side,
            },
            ..TestFrame::default()
        };
        let reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
        let plan = FramePlan::new(reader.header(), [30_000, 20_000], &PlanOptions::default());
        plan.unwrap().chunks()
    };
    let bytes_per_row = 30_000 * 3 * 2;
    let longest = u32::try_from(TILE_ROW_LIMIT_BYTES / bytes_per_row).unwrap() / 16 * 16;
    let kept = Chunks::Tiles {
        width_px: longest,
        height_px: longest,
    };
    assert_eq!(tiled(longest), kept);
    assert_eq!(tiled(longest + 16), Chunks::Strips { rows: 64 });

    // A frame of more than 4 GB - 64 kB becomes a BigTIFF, by its size or by what stands beside.
    let reader = FrameReader::new(Arc::new(TestFrame::default().bytes())).unwrap();
    let large = |size| FramePlan::new(reader.header(), size, &PlanOptions::default()).unwrap();
    assert!(large([30_000, 23_861]).is_big());
    let classic = large([30_000, 23_830]);
    assert!(!classic.is_big());
    assert!(classic.with_bytes_beside(10 << 20).is_big());
}

#[test]
fn crc_is_that_of_interleaved_little_endian_samples() {
    let mut crc = PixelCrc::default();
    crc.update(&[0x0201_u16, 0x0403]);
    let mut bytes = PixelCrc::default();
    bytes.update(&[1_u8, 2, 3, 4]);
    assert_eq!(crc.value(), bytes.value());
    // zlib.crc32(bytes([1, 2, 3, 4])) in Python.
    assert_eq!(crc.value(), 0xb63c_fbcd);
}

/// Runs of bytes by the text of TIFF 6.0, section 9.
fn unpacked(mut packed: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    while let [count, rest @ ..] = packed {
        let length = match count.cast_signed() {
            -128 => 0,
            count @ -127..0 => {
                bytes.extend(vec![rest[0]; 1 + usize::from(count.unsigned_abs())]);
                1
            }
            _ => {
                bytes.extend(&rest[..=usize::from(*count)]);
                1 + usize::from(*count)
            }
        };
        packed = &rest[length..];
    }
    bytes
}

#[test]
fn interpretation_and_fourth_sample_are_kept() {
    for (samples, photometric, extra, expected) in [
        (1, 0, None, vec![]),
        (3, 1, None, vec![0, 0]),
        (4, 2, None, vec![0]),
        (4, 2, Some(2), vec![2]),
        (4, 2, Some(1), vec![1]),
    ] {
        let frame = TestFrame {
            samples,
            entries: vec![shorts(262, &[photometric])],
            ..TestFrame::default()
        };
        let mut file = TiffBytes::new(frame.order, frame.big);
        let mut entries = frame.pixel_entries(&mut file);
        entries.retain(|(tag, _, _)| *tag != 338);
        entries.extend(extra.map(|extra| shorts(338, &[extra])));
        file.page(&entries, None);
        let reader = FrameReader::new(Arc::new(file.bytes)).unwrap();
        let plan = FramePlan::new(reader.header(), frame.size_px, &PlanOptions::default());
        let row_samples = reader.header().row_samples();
        let bytes = write(&plan.unwrap(), &frame.pixels(), 16, row_samples, None);
        let mut again = FrameReader::new(Arc::new(bytes)).unwrap();
        assert_eq!(again.header().photometric, photometric);
        assert_eq!(again.header().extra_samples, expected);
        assert_eq!(read(&mut again, 9), frame.pixels());
    }
}

#[test]
fn mask_is_a_second_page_of_one_bit() {
    let frame = TestFrame::default();
    let reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
    let plan = FramePlan::new(reader.header(), frame.size_px, &PlanOptions::default()).unwrap();
    let [width, height] = frame.size_px;
    let mut mask = Mask::new(frame.size_px);
    for row in 0..height {
        mask.push_row((0..width).map(|column| column > row))
            .unwrap();
    }
    assert!(mask.push_row([true]).is_err());
    let bytes = write(&plan, &frame.pixels(), 16, 111, Some(&mask));
    let reader = FrameReader::new(Arc::new(bytes.clone())).unwrap();
    assert_eq!(reader.metadata().dropped()[0].name, "page 2");
    assert_eq!(reader.metadata().dropped()[0].why, "mask");
    let mut decoder = Decoder::new(Cursor::new(&bytes)).unwrap();
    decoder.next_image().unwrap();
    let tags = [254, 256, 257, 258, 259, 262];
    let values = tags.map(|tag| decoder.get_tag_u32(tiff::tags::Tag::from_u16_exhaustive(tag)));
    assert_eq!(values.map(Result::unwrap), [4, 37, 29, 1, 32_773, 4]);

    let [offset, length] =
        [273, 279].map(|tag| decoder.get_tag_u32(tiff::tags::Tag::from_u16_exhaustive(tag)));
    let (start, length) = (offset.unwrap() as usize, length.unwrap() as usize);
    let rows = unpacked(&bytes[start..start + length]);
    assert_eq!(rows.len(), 5 * 29);
    for (place, byte) in rows.iter().enumerate() {
        for bit in 0..8 {
            let (column, row) = (place % 5 * 8 + bit, place / 5);
            let seen = column > row && column < 37;
            assert_eq!(byte >> (7 - bit) & 1 == 1, seen, "{column}, {row}");
        }
    }
}
