//! Tags are kept bit for bit, rewritten or dropped, and the drops are said.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::Arc;

use fmc_raster::{
    ByteOrder, ChunkEncoder, FramePlan, FrameReader, OutputTags, PlanOptions, RectifiedCamera,
    TagOptions, TiffFile,
};
use tiff::decoder::Decoder;
use tiff::tags::{IfdPointer, Tag, Type, ValueBuffer};

use crate::tiff_bytes::{Entry, TestFrame, TiffBytes, longs, shorts, text};

const CAMERA: RectifiedCamera = RectifiedCamera {
    focal_length_mm: 70.25,
    principal_point_mm: [26.5, 19.75],
};
const XMP: &str = "<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF \
    xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><rdf:Description rdf:about='' \
    xmlns:drone-dji='http://www.dji.com/drone-dji/1.0/' drone-dji:DewarpFlag='1' \
    drone-dji:GimbalYawDegree='+12.3'/></rdf:RDF></x:xmpmeta>";

fn bytes_of(numbers: impl IntoIterator<Item = u32>) -> Vec<u8> {
    numbers.into_iter().flat_map(u32::to_le_bytes).collect()
}

fn noise(length: usize) -> Vec<u8> {
    let mut random = fastrand::Rng::with_seed(length as u64);
    (0..length).map(|_| random.u8(..)).collect()
}

/// Tags of the frame's directory that are kept bit for bit.
fn kept() -> Vec<Entry> {
    vec![
        text(270, "Bündel 3, Streifen 7"),
        text(271, "Vexcel"),
        text(272, "iXM-RS150F"),
        (282, 5, bytes_of([300, 1])),
        (283, 5, bytes_of([300, 1])),
        shorts(296, &[2]),
        text(305, "IX Capture 3.1"),
        text(306, "2026:06:30 10:11:12"),
        text(315, "Flight crew"),
        text(33_432, "(c) 2026"),
        (33_723, 7, b"\x1c\x02\x78\x00\x04Tie!".to_vec()),
        (34_377, 1, b"8BIM\x04\x0a\0\0\0\0\0\x01\x01\0".to_vec()),
        (34_675, 7, noise(560)),
        text(
            42_112,
            "<GDALMetadata><Item name=\"a\">1</Item></GDALMetadata>",
        ),
        text(42_113, "0"),
        // Private tags of every type.
        (65_001, 1, noise(5)),
        (65_002, 3, noise(10)),
        (65_003, 4, noise(12)),
        (65_004, 5, noise(24)),
        (65_005, 6, noise(3)),
        (65_006, 7, noise(1)),
        (65_007, 8, noise(2)),
        (65_008, 9, noise(4)),
        (65_009, 10, noise(16)),
        (65_010, 11, noise(8)),
        (65_011, 12, noise(16)),
    ]
}

fn exif() -> Vec<Entry> {
    vec![
        (33_434, 5, bytes_of([1, 1250])),
        (36_864, 7, b"0232".to_vec()),
        text(36_867, "2026:06:30 10:11:12"),
        (37_386, 5, bytes_of([70, 1])),
        (37_500, 7, noise(999)),
        (37_380, 10, bytes_of([u32::MAX, 3])),
        longs(40_962, &[37]),
        text(42_033, "MM030049"),
    ]
}

fn interop() -> Vec<Entry> {
    vec![text(1, "R98"), (2, 7, b"0100".to_vec())]
}

fn gps() -> Vec<Entry> {
    vec![
        (0, 1, vec![2, 3, 0, 0]),
        text(1, "N"),
        (2, 5, bytes_of([47, 1, 22, 1, 123_456, 10_000])),
        text(3, "E"),
        (4, 5, bytes_of([8, 1, 32, 1, 54_321, 10_000])),
        (5, 1, vec![0]),
        (6, 5, bytes_of([123_456, 100])),
    ]
}

fn georeference() -> Vec<Entry> {
    let doubles = |numbers: &[f64]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    vec![
        (33_550, 12, doubles(&[0.1, 0.1, 0.0])),
        (33_922, 12, doubles(&[0.0, 0.0, 0.0, 7e5, 5e6, 0.0])),
        shorts(34_735, &[1, 1, 0, 1, 1024, 0, 1, 1]),
    ]
}

/// Tags that are dropped, with other pages.
fn dropped() -> Vec<Entry> {
    vec![
        shorts(280, &[0, 0, 0]),
        longs(330, &[8]),
        (34_264, 12, vec![0; 128]),
        (37_724, 7, noise(64)),
        (65_012, 99, noise(4)),
    ]
}

/// Returns a file with all of them, a reduced image before the frame, and a second frame.
fn input(order: ByteOrder, big: bool) -> Vec<u8> {
    file(order, big, true)
}

pub(crate) fn file(order: ByteOrder, big: bool, pages_beside: bool) -> Vec<u8> {
    let mut file = TiffBytes::new(order, big);
    let offset = |place: usize| u32::try_from(place).unwrap();
    let mut exif = exif();
    exif.push(longs(40_965, &[offset(file.directory(&interop()))]));
    let pointers = [
        longs(34_665, &[offset(file.directory(&exif))]),
        longs(34_853, &[offset(file.directory(&gps()))]),
    ];
    let frame = TestFrame {
        order,
        big,
        entries: [
            kept(),
            georeference(),
            dropped(),
            pointers.to_vec(),
            vec![(700, 1, XMP.into())],
        ]
        .concat(),
        ..TestFrame::default()
    };
    let reduced = TestFrame {
        entries: vec![longs(254, &[1])],
        ..TestFrame {
            order,
            big,
            ..TestFrame::default()
        }
    };
    let other = TestFrame {
        entries: vec![],
        ..reduced.clone()
    };
    if pages_beside {
        let end = reduced.append(&mut file, None);
        let end = frame.append(&mut file, Some(end));
        other.append(&mut file, Some(end));
    } else {
        frame.append(&mut file, None);
    }
    file.bytes
}

pub(crate) fn copy(input: &[u8], options: &TagOptions, big: bool) -> (Vec<u8>, OutputTags) {
    let mut reader = FrameReader::new(Arc::new(input.to_vec())).unwrap();
    let options_of_plan = PlanOptions {
        big,
        ..PlanOptions::default()
    };
    let plan = FramePlan::new(reader.header(), [37, 29], &options_of_plan).unwrap();
    let tags = reader.metadata().output(options);
    let mut out = Cursor::new(Vec::new());
    let mut file = TiffFile::new(&mut out, &plan).unwrap();
    let mut frame = file.frame(&plan, &tags).unwrap();
    let mut rows = vec![0_u16; 37 * 29 * 3];
    assert_eq!(reader.read_rows(&mut rows).unwrap(), 29);
    let mut encoder = ChunkEncoder::new(&plan).unwrap();
    encoder
        .encode(&rows, &mut |piece| frame.write(piece))
        .unwrap();
    frame.finish().unwrap();
    (out.into_inner(), tags)
}

/// A directory as the crate `tiff` reads it: type and little-endian bytes of every tag.
fn directory(
    decoder: &mut Decoder<Cursor<Vec<u8>>>,
    pointer: IfdPointer,
) -> BTreeMap<u16, (u16, Vec<u8>)> {
    let entries = decoder.read_directory(pointer).unwrap();
    let tags: Vec<Tag> = entries.iter().map(|(tag, _)| tag).collect();
    let mut values = decoder.read_directory_tags(&entries);
    let mut found = BTreeMap::new();
    for tag in tags {
        let mut value = ValueBuffer::empty(Type::BYTE);
        values.find_tag_buf(tag, &mut value).unwrap().unwrap();
        value.set_byte_order(ByteOrder::LittleEndian);
        found.insert(
            tag.to_u16(),
            (value.data_type().to_u16(), value.as_bytes().to_vec()),
        );
    }
    found
}

fn assert_holds(found: &BTreeMap<u16, (u16, Vec<u8>)>, expected: &[Entry]) {
    for (tag, value_type, bytes) in expected {
        assert_eq!(found[tag], (*value_type, bytes.clone()), "tag {tag}");
    }
}

fn pointer(found: &BTreeMap<u16, (u16, Vec<u8>)>, tag: u16) -> IfdPointer {
    let mut offset = [0; 8];
    offset[..found[&tag].1.len()].copy_from_slice(&found[&tag].1);
    IfdPointer(u64::from_le_bytes(offset))
}

#[test]
fn all_kept_tags_are_kept_bit_for_bit() {
    for (order, big, big_output) in [
        (ByteOrder::LittleEndian, false, false),
        (ByteOrder::BigEndian, false, false),
        (ByteOrder::LittleEndian, true, true),
        (ByteOrder::BigEndian, true, true),
        (ByteOrder::BigEndian, false, true),
    ] {
        let options = TagOptions {
            keep_georeference: true,
            camera: None,
        };
        let (output, _) = copy(&input(order, big), &options, big_output);
        let mut decoder = Decoder::new(Cursor::new(output)).unwrap();
        let first = decoder.ifd_pointer().unwrap();
        assert!(!decoder.more_images());
        let page = directory(&mut decoder, first);
        assert_holds(&page, &kept());
        assert_holds(&page, &[(700, 1, XMP.into())]);
        let places: [&[Entry]; 2] = [&georeference(), &[(34_264, 12, vec![0; 128])]];
        assert_holds(&page, &places.concat());
        let pixels = [
            256, 257, 258, 259, 262, 273, 274, 277, 278, 279, 284, 339, 34_665, 34_853, 34_264, 700,
        ];
        assert_eq!(
            page.len(),
            kept().len() + georeference().len() + pixels.len()
        );
        let exif_found = directory(&mut decoder, pointer(&page, 34_665));
        assert_holds(&exif_found, &exif());
        assert_eq!(exif_found.len(), exif().len() + 1);
        let interop_found = directory(&mut decoder, pointer(&exif_found, 40_965));
        assert_holds(&interop_found, &interop());
        assert_eq!(interop_found.len(), interop().len());
        let gps_found = directory(&mut decoder, pointer(&page, 34_853));
        assert_holds(&gps_found, &gps());
        assert_eq!(gps_found.len(), gps().len());
    }
}

#[test]
fn first_of_two_equal_tags_is_kept() {
    let frame = TestFrame::default();
    let mut file = TiffBytes::new(frame.order, frame.big);
    let mut entries = frame.pixel_entries(&mut file);
    entries.extend([(65_000, 7, noise(9)), (65_000, 7, noise(10))]);
    file.page(&entries, None);
    let (output, tags) = copy(&file.bytes, &TagOptions::default(), false);
    let said = tags.dropped().iter().map(|it| (it.name.as_str(), it.why));
    assert!(said.eq([("tag 65000", "it comes a second time")]));
    let mut decoder = Decoder::new(Cursor::new(output)).unwrap();
    let first = decoder.ifd_pointer().unwrap();
    assert_holds(&directory(&mut decoder, first), &[(65_000, 7, noise(9))]);
}

#[test]
fn directories_and_values_begin_at_even_offsets() {
    for big in [false, true] {
        let frame = TestFrame {
            size_px: [37, 3],
            samples: 1,
            bits: 8,
            entries: vec![(65_000, 7, noise(9)), (65_001, 5, noise(8))],
            ..TestFrame::default()
        };
        let mut reader = FrameReader::new(Arc::new(frame.bytes())).unwrap();
        let options = PlanOptions {
            big,
            ..PlanOptions::default()
        };
        let plan = FramePlan::new(reader.header(), frame.size_px, &options).unwrap();
        let tags = reader.metadata().output(&TagOptions::default());
        let mut rows = [0_u8; 37 * 3];
        reader.read_rows(&mut rows).unwrap();
        let mut out = Cursor::new(Vec::new());
        let mut file = TiffFile::new(&mut out, &plan).unwrap();
        let mut page = file.frame(&plan, &tags).unwrap();
        let mut encoder = ChunkEncoder::new(&plan).unwrap();
        encoder
            .encode(&rows, &mut |piece| page.write(piece))
            .unwrap();
        page.finish().unwrap();
        let bytes = out.into_inner();
        let position = |pattern: &[u8]| {
            let mut windows = bytes.windows(pattern.len());
            windows.position(|window| window == pattern).unwrap()
        };
        // 111 bytes of pixels follow the first value, and the directory follows them.
        assert_eq!(position(&noise(9)) % 2, 0);
        assert!(big || position(&noise(8)) % 2 == 0);
        let field = if big { 8 } else { 4 };
        assert_eq!(bytes[field] % 2, 0);
    }
}

#[test]
fn what_is_dropped_is_said_once() {
    let options = TagOptions {
        keep_georeference: false,
        camera: Some(CAMERA),
    };
    let (output, tags) = copy(&input(ByteOrder::BigEndian, false), &options, false);
    let said: Vec<String> = tags
        .dropped()
        .iter()
        .map(|it| format!("{}: {}", it.name, it.why))
        .collect();
    assert_eq!(
        said,
        [
            "page 1: reduced image",
            "page 3: only the first page of full resolution is taken",
            "MinSampleValue (280): extremes of the pixels as recorded",
            "SubIFDs (330): reduced images and other sub-images",
            "ImageSourceData (37724): layers of the pixels as recorded",
            "tag 65012: its type is none of TIFF or BigTIFF",
            "ModelPixelScale (33550): the pixels moved",
            "ModelTiepoint (33922): the pixels moved",
            "ModelTransformation (34264): the pixels moved",
            "GeoKeyDirectory (34735): the pixels moved",
            "drone-dji:DewarpFlag: asks to correct the lens again",
        ]
    );
    let mut decoder = Decoder::new(Cursor::new(output)).unwrap();
    let first = decoder.ifd_pointer().unwrap();
    let page = directory(&mut decoder, first);
    assert_holds(&page, &kept());
    for tag in [280, 330, 33_550, 33_922, 34_264, 34_735, 37_724, 65_012] {
        assert!(!page.contains_key(&tag), "tag {tag}");
    }
    let xmp = String::from_utf8(page[&700].1.clone()).unwrap();
    assert!(xmp.contains("drone-dji:GimbalYawDegree=\"+12.3\""));
    assert!(!xmp.contains("DewarpFlag"));
    assert!(xmp.contains("Camera:PerspectiveFocalLength=\"70.25\""));
    assert!(xmp.contains("Camera:PrincipalPoint=\"26.5,19.75\""));
    assert!(xmp.contains("Camera:PerspectiveDistortion=\"0,0,0,0,0\""));
}

#[test]
fn packet_that_is_no_xmp_is_replaced_and_said() {
    let frame = TestFrame {
        entries: vec![(700, 7, b"<x:xmpmeta".to_vec())],
        ..TestFrame::default()
    };
    let options = TagOptions {
        keep_georeference: false,
        camera: Some(CAMERA),
    };
    let (output, tags) = copy(&frame.bytes(), &options, false);
    assert_eq!(tags.dropped().len(), 1);
    assert!(tags.dropped()[0].why.contains("no well-formed XMP"));
    let text = String::from_utf8_lossy(&output).into_owned();
    assert_eq!(
        text.matches("Camera:PrincipalPoint=\"26.5,19.75\"").count(),
        1
    );
    // A frame without a packet gets one.
    let (output, tags) = copy(&TestFrame::default().bytes(), &options, false);
    assert!(tags.dropped().is_empty());
    assert!(String::from_utf8_lossy(&output).contains("Camera:ModelType=\"perspective\""));
}
