//! Points of many frames as arrays of NumPy.

use std::fmt::Write as _;
use std::fs;

use super::flight::{Flight, RECORDS, flight};
use crate::command_line::support::{Bench, CAMERA, EXPOSURE};

/// Returns an array as `numpy.save` writes it.
fn array(description: &str, shape: &str, rows: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': {description}, 'fortran_order': False, 'shape': {shape}, }}");
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(length).unwrap().to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.resize(10 + length - 1, b' ');
    bytes.push(b'\n');
    bytes.extend(rows);
    bytes
}

/// Returns header and rows of an array.
fn parts(bytes: &[u8]) -> (String, Vec<u8>) {
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let (header, rows) = bytes.split_at(10 + length);
    (
        String::from_utf8_lossy(&header[10..]).trim_end().to_owned(),
        rows.to_vec(),
    )
}

fn run(flight: &Flight, points: &[u8], more: &[&str]) -> (String, Vec<u8>) {
    fs::write(flight.bench.path("points.npy"), points).unwrap();
    let files = ["points.npy", "--out", "answer.npy"];
    flight
        .bench
        .run(&[&["correct"], &RECORDS[..], more, &files].concat())
        .ok();
    parts(&fs::read(flight.bench.path("answer.npy")).unwrap())
}

#[test]
fn rows_have_the_bytes_of_single_calls() {
    // More points than a block has, and fewer than the vectors take.
    assert_bytes_of_single_calls(5, |sequence| if sequence % 2 == 0 { 9_001 } else { 17 });
}

#[test]
#[ignore = "ten thousand processes, some minutes"]
fn rows_of_1e4_frames_have_the_bytes_of_1e4_single_calls() {
    assert_bytes_of_single_calls(10_000, |_| 1_000);
}

/// Corrects frames in one call and one after the other, and compares the bytes.
fn assert_bytes_of_single_calls(frames: u16, points: impl Fn(u16) -> usize) {
    let bench = Bench::with(CAMERA, b"");
    let mut random = fastrand::Rng::with_seed(9);
    let mut table = String::from("sequence,vh,exposure,focus_shift_um\n");
    let (mut rows, mut expected) = (Vec::new(), Vec::new());
    for sequence in 1..=frames {
        let shift = f32::from(sequence % 50) - 2.0;
        writeln!(table, "{sequence},0.1,1/200,{shift}").unwrap();
        let mut single = Vec::new();
        let count = points(sequence);
        for _ in 0..count {
            let point = [(); 2].map(|()| 80.0 * (random.f32() - 0.5));
            rows.extend(
                [f32::from(sequence), point[0], point[1]]
                    .map(f32::to_le_bytes)
                    .concat(),
            );
            single.extend(point.map(f32::to_le_bytes).concat());
        }
        let shape = format!("({count}, 2)");
        fs::write(bench.path("single.npy"), array("'<f4'", &shape, &single)).unwrap();
        let shift = shift.to_string();
        let more = ["--focus-shift-um", &shift, "single.npy", "--out", "out.npy"];
        bench
            .run(&[&["correct"], &EXPOSURE[..], &more].concat())
            .ok();
        expected.extend(parts(&fs::read(bench.path("out.npy")).unwrap()).1);
    }
    fs::write(bench.path("frames.csv"), table).unwrap();
    let shape = format!("({}, 3)", rows.len() / 12);
    fs::write(bench.path("points.npy"), array("'<f4'", &shape, &rows)).unwrap();
    let arguments = [
        "correct",
        "--camera",
        "camera.toml",
        "--frames",
        "frames.csv",
    ];
    let files = ["points.npy", "--out", "all.npy"];
    bench.run(&[&arguments[..], &files].concat()).ok();
    let (header, all) = parts(&fs::read(bench.path("all.npy")).unwrap());
    let shape = format!("'shape': ({}, 4, )", rows.len() / 12);
    let shape = format!("'descr': '<f4', 'fortran_order': False, {shape}");
    assert!(header.contains(&shape), "{header}");
    assert!(all == expected, "not the same bytes");
}

#[test]
fn structured_rows_keep_their_fields_and_have_the_numbers_of_the_text() {
    let flight = flight();
    let mut rows = Vec::new();
    let mut text = String::from("sequence,x_mm,y_mm\n");
    for (index, sequence) in [3_u8, 1, 8, 3].into_iter().enumerate() {
        let y = 2.5 * f64::from(sequence);
        let x = -11.25 * f64::from(u8::try_from(index).unwrap());
        rows.extend(y.to_le_bytes());
        rows.extend(b"ab\0");
        rows.extend(u16::from(sequence).to_le_bytes());
        rows.extend(x.to_le_bytes());
        writeln!(text, "{sequence},{x},{y}").unwrap();
    }
    fs::write(flight.bench.path("points.csv"), text).unwrap();
    let csv = flight
        .bench
        .run(&[&["correct"], &RECORDS[..], &["points.csv"]].concat())
        .ok();
    let fields = "[('y_mm', '<f8'), ('tag', '|S3'), ('sequence', '<u2'), ('x_mm', '<f8')]";
    let (header, answer) = run(
        &flight,
        &array(fields, "(4,)", &rows),
        &["--off-sensor", "flag"],
    );
    let added = fields.replace(']', ", ('dx_um', '<f8'), ('dy_um', '<f8'), ('sigma_x_um', '<f8'), ('sigma_y_um', '<f8'), ('flag', '|u1')]");
    assert!(header.contains(&added), "{header}");
    assert_eq!(answer.len(), 4 * (21 + 4 * 8 + 1));
    let mut reader = csv::Reader::from_reader(csv.stdout.as_bytes());
    for (row, expected) in answer.chunks(54).zip(reader.records()) {
        let expected = expected.unwrap();
        assert_eq!(row[8..11], *b"ab\0");
        assert_eq!(row[11].to_string(), expected[0]);
        assert_eq!(row[53], 0);
        for (offset, cell) in [(13, 1), (0, 2), (21, 3), (29, 4), (37, 5), (45, 6)] {
            let number = f64::from_le_bytes(*row[offset..].first_chunk().unwrap());
            let decimals = if cell < 3 { 9 } else { 6 };
            assert_eq!(format!("{:.decimals$}", number + 0.0), expected[cell]);
        }
    }
}

#[test]
fn frames_are_named_by_numbers_and_texts_of_every_type() {
    let flight = flight();
    let one = |type_name: &str, name: &str, bytes: &[u8], more: &[&str]| {
        let fields = format!("[('{name}', '{type_name}'), ('x_mm', '<f4'), ('y_mm', '<f4')]");
        let rows = [bytes, &1.0_f32.to_le_bytes(), &2.0_f32.to_le_bytes()].concat();
        let (_, answer) = run(&flight, &array(&fields, "(1,)", &rows), more);
        answer[bytes.len()..].to_vec()
    };
    let expected = one("<u4", "sequence", &[7, 0, 0, 0], &[]);
    for (type_name, bytes) in [
        ("|u1", &[7_u8][..]),
        ("<i2", &[7, 0]),
        ("<i8", &[7, 0, 0, 0, 0, 0, 0, 0]),
        ("<f4", &7.0_f32.to_le_bytes()),
        ("<f8", &7.0_f64.to_le_bytes()),
        ("|S4", b"7\0\0\0"),
        ("<U2", b"7\0\0\0\0\0\0\0"),
    ] {
        assert_eq!(one(type_name, "frame", bytes, &[]), expected, "{type_name}");
    }
    let images = ["--images", "images.csv"];
    assert_eq!(one("|S12", "image", b"IMG, 007.tif", &images), expected);
    let wide: Vec<u8> = "IMG, 007.tif"
        .chars()
        .flat_map(|c| u32::from(c).to_le_bytes())
        .collect();
    assert_eq!(one("<U12", "image", &wide, &images), expected);
}

#[test]
fn arrays_without_points_of_frames_are_refused() {
    let flight = flight();
    let good = "[('sequence', '<u4'), ('x_mm', '<f4'), ('y_mm', '<f4')]";
    let row = [0_u8; 12];
    let with = |sequence: f32, x: f32| [sequence, x, 0.0].map(f32::to_le_bytes).concat();
    let refused = |points: &[u8], more: &[&str], words: &str| {
        fs::write(flight.bench.path("points.npy"), points).unwrap();
        let arguments = [&["correct"], &RECORDS[..], more, &["points.npy"]].concat();
        flight.bench.run(&arguments).refused(&[words]);
    };
    refused(
        &array("'<f4'", "(1, 2)", &row),
        &[],
        "the array has the shape [1, 2]",
    );
    refused(
        &array("'<i4'", "(1, 3)", &row),
        &[],
        "the array is of type <i4",
    );
    refused(
        &array(good, "(1, 1)", &row),
        &[],
        "the array has the shape [1, 1], not (N,)",
    );
    let without = good.replace("sequence", "number");
    refused(
        &array(&without, "(1,)", &row),
        &[],
        "column sequence, frame or image is missing",
    );
    let big = good.replace("'x_mm', '<f4'", "'x_mm', '>f4'");
    refused(
        &array(&big, "(1,)", &row),
        &[],
        "has the field x_mm of type >f4; it must be <f4 or <f8",
    );
    let mixed = good.replace("'y_mm', '<f4'", "'y_mm', '<f8'");
    refused(
        &array(&mixed, "(1,)", &[0; 16]),
        &[],
        "has the field y_mm of type <f8; it must be <f4, as x_mm",
    );
    refused(
        &array("'<f4'", "(1, 3)", &with(9.0, 0.0)),
        &[],
        "points.npy, row 0: sequence = 9: records.csv has no",
    );
    refused(
        &array("'<f4'", "(1, 3)", &with(1.5, 0.0)),
        &[],
        "row 0: sequence = 1.5 is not a whole number",
    );
    refused(
        &array("'<f4'", "(1, 3)", &with(f32::NAN, 0.0)),
        &[],
        "row 0: sequence = NaN is not a whole number",
    );
    refused(
        &array("'<f4'", "(1, 3)", &with(1.0, f32::NAN)),
        &[],
        "row 0: frame 1: the point x_mm = NaN",
    );
    refused(
        &array("'<f4'", "(1, 3)", &with(5.0, 0.0)),
        &[],
        "row 0: frame 5: its trigger was refused",
    );
    refused(
        &array("'<f4'", "(2, 3)", &with(1.0, 0.0)),
        &[],
        "the file ends before the 2 rows of its array",
    );
    let more = [with(1.0, 0.0), with(1.0, 0.0)].concat();
    refused(
        &array("'<f4'", "(1, 3)", &more),
        &["--out", "more.npy"],
        "the file goes on behind the 1 rows",
    );
    refused(
        &array("'<f4'", "(1, 3)", &with(1.0, 0.0)),
        &["--off-sensor", "skip"],
        "--off-sensor skip: the header of an array",
    );
    // A mark without a field is a NaN.
    let (_, answer) = run(
        &flight,
        &array("'<f4'", "(1, 3)", &with(5.0, 0.0)),
        &["--off-sensor", "flag"],
    );
    assert!(f32::from_le_bytes(*answer.first_chunk().unwrap()).is_nan());
}
