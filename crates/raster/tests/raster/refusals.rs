//! A file that is no frame is an error that names field, value and what is allowed.

use std::path::Path;
use std::sync::Arc;

use fmc_raster::{ByteOrder, Chunks, Compression, FrameReader};

use crate::tiff_bytes::{Entry, TestFrame, TiffBytes, longs, shorts};

fn message(bytes: Vec<u8>) -> String {
    let mut reader = match FrameReader::new(Arc::new(bytes)) {
        Ok(reader) => reader,
        Err(error) => return error.to_string(),
    };
    let mut rows = vec![0_u16; 5 * reader.header().row_samples()];
    loop {
        match reader.read_rows(&mut rows) {
            Ok(0) => return String::new(),
            Ok(_) => {}
            Err(error) => return error.to_string(),
        }
    }
}

fn with(entries: Vec<Entry>) -> String {
    message(
        TestFrame {
            entries,
            ..TestFrame::default()
        }
        .bytes(),
    )
}

#[test]
fn whole_frame_is_read() {
    assert_eq!(with(Vec::new()), "");
}

#[test]
fn what_is_no_tiff_is_named() {
    assert_eq!(
        message(Vec::new()),
        "the file is empty; a TIFF has at least 8 bytes"
    );
    let not = |start: &str| {
        format!(
            "not a TIFF: it begins with the bytes [{start}], a TIFF with II 42, MM 42, II 43 or MM 43"
        )
    };
    assert_eq!(
        message(b"\x89PNG\r\n\x1a\n".to_vec()),
        not("89, 50, 4e, 47")
    );
    assert_eq!(message(b"I".to_vec()), not("49"));
    assert_eq!(message(b"II*\0\x08\0\0".to_vec()), not("49, 49, 2a, 00"));
    assert_eq!(
        message(b"MM\0+\0\x04\0\0\0\0\0\0\0\0\0\0".to_vec()),
        not("4d, 4d, 00, 2b")
    );
    let folder = tempfile::tempdir().unwrap();
    let open = |path: &Path| FrameReader::open(path).unwrap_err().to_string();
    assert_eq!(open(folder.path()), "a folder, not a TIFF file");
    assert!(open(&folder.path().join("none.tif")).starts_with("open: "));
}

#[test]
fn fields_that_are_not_read_are_named_with_what_is_allowed() {
    for (entry, expected) in [
        (
            longs(256, &[0]),
            "ImageWidth (256) = 0; allowed: 1 to 300000",
        ),
        (
            longs(257, &[u32::MAX]),
            "ImageLength (257) = 4294967295; allowed: 1 to 300000",
        ),
        (
            shorts(258, &[12, 12, 12]),
            "BitsPerSample (258) = 12; allowed: 8, 16 in all samples",
        ),
        (
            shorts(258, &[8, 8, 16]),
            "BitsPerSample (258) = 16; allowed: the same for all samples",
        ),
        (
            shorts(258, &[32, 32, 32]),
            "BitsPerSample (258) = 32; allowed: 8, 16 in all samples",
        ),
        (
            shorts(258, &[16, 16]),
            "BitsPerSample (258) has 2 values of type 3; allowed: 1 value, or 3",
        ),
        (
            shorts(259, &[34_712]),
            "Compression (259) = 34712; allowed: 1 (none), 5 (LZW), 8 and 32946 (Deflate), 32773 \
             (PackBits), 50000 (zstd)",
        ),
        (
            shorts(259, &[7]),
            "Compression (259) = 7; allowed: 1 (none)",
        ),
        (
            shorts(262, &[6]),
            "PhotometricInterpretation (262) = 6; allowed: 0 (white is zero), 1 (black is zero), \
             2 (RGB)",
        ),
        (shorts(262, &[3]), "PhotometricInterpretation (262) = 3;"),
        (shorts(262, &[5]), "PhotometricInterpretation (262) = 5;"),
        (
            shorts(262, &[32_803]),
            "PhotometricInterpretation (262) = 32803;",
        ),
        (shorts(266, &[2]), "FillOrder (266) = 2; allowed: 1"),
        (
            shorts(274, &[6]),
            "Orientation (274) = 6; allowed: 1 (the rows and columns as recorded)",
        ),
        (
            shorts(277, &[2]),
            "SamplesPerPixel (277) = 2; allowed: 1, 3, 4",
        ),
        (
            shorts(277, &[5]),
            "SamplesPerPixel (277) = 5; allowed: 1, 3, 4",
        ),
        (
            shorts(284, &[3]),
            "PlanarConfiguration (284) = 3; allowed: 1 (chunky), 2 (planar)",
        ),
        (
            shorts(317, &[3]),
            "Predictor (317) = 3; allowed: 1 (none), 2 (horizontal differences)",
        ),
        (
            shorts(339, &[3, 3, 3]),
            "SampleFormat (339) = 3; allowed: 1 (unsigned integers)",
        ),
        (
            longs(278, &[0]),
            "RowsPerStrip (278) = 0; allowed: 1 and more",
        ),
        (
            longs(278, &[4]),
            "StripOffsets (273) has 4 values of type 4; allowed: 8 unsigned integers",
        ),
        (
            (256, 2, b"37\0".to_vec()),
            "ImageWidth (256) has 3 values of type 2; allowed: 1 unsigned integer",
        ),
        (
            (256, 2, b"\0".to_vec()),
            "ImageWidth (256) has 1 values of type 2; allowed: unsigned integers",
        ),
    ] {
        let message = with(vec![entry]);
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn samples_that_contradict_the_interpretation_are_named() {
    let grey = TestFrame {
        samples: 1,
        entries: vec![shorts(262, &[2])],
        ..TestFrame::default()
    };
    assert_eq!(
        message(grey.bytes()),
        "SamplesPerPixel (277) = 1 does not fit PhotometricInterpretation (262) = 2; allowed: 3, 4 \
         samples of RGB"
    );
}

#[test]
fn missing_fields_are_named() {
    let frame = TestFrame::default();
    for tag in [256, 257, 262, 273, 279] {
        let mut file = TiffBytes::new(frame.order, frame.big);
        let mut entries = frame.pixel_entries(&mut file);
        entries.retain(|(number, _, _)| *number != tag);
        file.page(&entries, None);
        let expected = format!("{} is missing", fmc_raster::Tag(tag));
        assert_eq!(message(file.bytes), expected);
    }
}

#[test]
fn places_beyond_the_file_are_named() {
    let length = TestFrame::default().bytes().len();
    assert_eq!(
        with(vec![longs(273, &[8, 8, 1_000_000, 8])]),
        format!(
            "StripByteCounts (279): chunk 2 has 1776 bytes at byte 1000000, the file has {length} \
             bytes"
        )
    );
    assert_eq!(
        with(vec![longs(279, &[1776, 1776, 1776, u32::MAX])]),
        format!(
            "StripByteCounts (279): chunk 3 has 4294967295 bytes at byte 5336, the file has \
             {length} bytes"
        )
    );
    assert_eq!(
        with(vec![longs(279, &[1776, 1775, 1776, 1110])]),
        "StripByteCounts (279): chunk 1 has 1775 bytes; its pixels need at least 1776"
    );
    assert_eq!(
        with(vec![longs(273, &[8, 0, 8, 8])]),
        "StripByteCounts (279): chunk 1 is absent (offset 0, 1776 bytes)"
    );
    // A directory that EXIF points to.
    assert!(
        with(vec![longs(34_665, &[1_000_000])]).starts_with(
            "directory of EXIF directory (34665) begins at byte 1000000, the file has"
        )
    );
    // The offset of the first directory, and of a value.
    let mut bytes = TestFrame::default().bytes();
    bytes[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(
        message(bytes),
        format!("directory of page 1 begins at byte 4294967295, the file has {length} bytes")
    );
    let mut file = TiffBytes::new(ByteOrder::LittleEndian, false);
    let mut entries = TestFrame::default().pixel_entries(&mut file);
    entries.push((65_000, 7, vec![0; 9]));
    let end = file.page(&entries, None);
    // The last entry is before the link: tag, type, count, offset.
    let _ = end;
    let place = file.bytes.len() - 4 - 8;
    file.bytes[place..place + 4].copy_from_slice(&3_000_000_000_u32.to_le_bytes());
    assert!(message(file.bytes).starts_with("tag 65000: 3000000000 bytes at byte "));
}

#[test]
fn truncated_files_are_named_by_what_is_cut_off() {
    // The pixels stand before the directory in one file, behind it in the other.
    let bytes = TestFrame::default().bytes();
    let length = bytes.len() - 7;
    let cut = message(bytes[..length].to_vec());
    assert!(cut.ends_with(&format!(
        "is cut off: it has 10 entries, the file {length} bytes"
    )));
    let frame = TestFrame {
        chunks: Chunks::Strips { rows: 29 },
        ..TestFrame::default()
    };
    let mut file = TiffBytes::new(frame.order, frame.big);
    let pixels = frame.pixel_entries(&mut file);
    let chunk = file.bytes.split_off(8);
    let entries: Vec<Entry> = pixels
        .into_iter()
        .map(|entry| match entry.0 {
            273 => longs(273, &[1000]),
            _ => entry,
        })
        .collect();
    file.page(&entries, None);
    file.bytes.resize(1000, 0);
    file.bytes.extend(&chunk);
    assert_eq!(message(file.bytes.clone()), "");
    file.bytes.truncate(5000);
    assert_eq!(
        message(file.bytes),
        "StripByteCounts (279): chunk 0 has 6438 bytes at byte 1000, the file has 5000 bytes"
    );
}

#[test]
fn damaged_pixels_are_named_by_chunk_and_row() {
    for (compression, expected) in [
        (Compression::Lzw, "chunk 1, from row 8 on: "),
        (Compression::Deflate, "chunk 1, from row 8 on: "),
        (Compression::Zstd, "chunk 1, from row 8 on: "),
        (
            Compression::PackBits,
            "chunk 1, from row 8 on: its data end before its last row",
        ),
    ] {
        let frame = TestFrame {
            compression,
            ..TestFrame::default()
        };
        let mut file = TiffBytes::new(frame.order, frame.big);
        let entries = frame.pixel_entries(&mut file);
        let offsets = entries.iter().find(|(tag, _, _)| *tag == 273).unwrap();
        let place = |index: usize| {
            let bytes = offsets.2[4 * index..][..4].try_into().unwrap();
            u32::from_le_bytes(bytes) as usize
        };
        let (start, end) = (place(1), place(2));
        file.page(&entries, None);
        assert_eq!(message(file.bytes.clone()), "");
        let noop = if compression == Compression::PackBits {
            128
        } else {
            0xff
        };
        file.bytes[start + 2..end].fill(noop);
        let message = message(file.bytes);
        assert!(message.starts_with(expected), "{compression}: {message}");
    }
}

#[test]
fn checksums_of_deflate_that_are_wrong_cut_off_or_absent_are_named() {
    for chunks in [
        Chunks::Strips { rows: 29 },
        Chunks::Tiles {
            width_px: 48,
            height_px: 32,
        },
    ] {
        let frame = TestFrame {
            compression: Compression::Deflate,
            size_px: [48, 32],
            chunks,
            ..TestFrame::default()
        };
        let of_checksum = |cut: u32, flipped: u8| {
            let mut file = TiffBytes::new(frame.order, frame.big);
            let mut entries = frame.pixel_entries(&mut file);
            let last = file.bytes.len() - 1;
            file.bytes[last] ^= flipped;
            let lengths = entries
                .iter_mut()
                .find(|(tag, _, _)| [279, 325].contains(tag));
            let lengths = lengths.unwrap();
            let numbers = lengths.2.chunks_exact(4);
            let mut numbers: Vec<u32> = numbers
                .map(|number| u32::from_le_bytes(number.try_into().unwrap()))
                .collect();
            *numbers.last_mut().unwrap() -= cut;
            *lengths = longs(lengths.0, &numbers);
            file.page(&entries, None);
            let message = message(file.bytes);
            message.split_once(": ").unwrap().1.to_owned()
        };
        for cut in 1..=4 {
            let expected = "the checksum behind its rows is cut off or missing";
            assert_eq!(of_checksum(cut, 0), expected);
        }
        let wrong = "the checksum behind its rows is not that of its bytes";
        assert_eq!(of_checksum(0, 1), wrong);
    }
}

#[test]
fn pages_in_a_circle_and_without_a_frame_are_named() {
    let frame = TestFrame::default();
    let mut file = TiffBytes::new(frame.order, frame.big);
    let end = frame.append(&mut file, None);
    let first = u32::from_le_bytes(file.bytes[4..8].try_into().unwrap());
    file.bytes[end - 4..].copy_from_slice(&first.to_le_bytes());
    assert_eq!(
        message(file.bytes),
        format!("directory at byte {first} comes twice, or is behind 1024 others")
    );
    assert_eq!(
        with(vec![longs(254, &[1])]),
        "none of 1 pages is an image of full resolution (NewSubfileType 0)"
    );
}

#[test]
fn tiles_that_the_file_cannot_hold_are_refused_before_memory_is_taken() {
    let frame = TestFrame {
        compression: Compression::Zstd,
        chunks: Chunks::Tiles {
            width_px: 48,
            height_px: 32,
        },
        ..TestFrame::default()
    };
    let mut file = TiffBytes::new(frame.order, frame.big);
    let mut entries = frame.pixel_entries(&mut file);
    for entry in &mut entries {
        match entry.0 {
            256 => *entry = longs(256, &[299_984]),
            257 => *entry = longs(257, &[299_984]),
            322 => *entry = longs(322, &[299_984]),
            323 => *entry = longs(323, &[299_984]),
            _ => {}
        }
    }
    file.page(&entries, None);
    assert!(message(file.bytes).starts_with("TileByteCounts (325): chunk 0 has "));
}

#[test]
fn rows_of_other_samples_are_refused() {
    let mut reader = FrameReader::new(Arc::new(TestFrame::default().bytes())).unwrap();
    let error = reader.read_rows(&mut [0_u8; 111]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "BitsPerSample (258) = 16, read as 8 bits"
    );
}
