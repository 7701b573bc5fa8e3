//! Points of many frames in Parquet.

use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::parser::parse_message_type;

use super::flight::{RECORDS, REFUSED, flight};

const SCHEMA: &str = "message points {
    optional binary name (UTF8);
    required int32 sequence;
    optional double x_mm;
    required double y_mm;
    optional int64 taken (TIMESTAMP_MICROS);
}";

/// A point: the name and the time are missing where they are `None`.
type Point = (Option<&'static str>, i32, [f64; 2], Option<i64>);

/// Writes points in groups of so many rows.
fn write(path: &Path, points: &[Point], group: usize, compression: Compression) {
    let schema = Arc::new(parse_message_type(SCHEMA).unwrap());
    let properties = WriterProperties::builder().set_compression(compression);
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties.build())).unwrap();
    for points in points.chunks(group) {
        let mut rows = writer.next_row_group().unwrap();
        let levels = |has: &dyn Fn(&Point) -> bool| -> Vec<i16> {
            points.iter().map(|point| i16::from(has(point))).collect()
        };
        macro_rules! column {
            ($kind:ty, $values:expr, $levels:expr) => {
                let mut column = rows.next_column().unwrap().unwrap();
                let values: Vec<_> = $values.collect();
                let levels: Option<Vec<i16>> = $levels;
                let typed = column.typed::<$kind>();
                typed.write_batch(&values, levels.as_deref(), None).unwrap();
                column.close().unwrap();
            };
        }
        let names = points
            .iter()
            .filter_map(|point| point.0.map(ByteArray::from));
        column!(
            ByteArrayType,
            names,
            Some(levels(&|point| point.0.is_some()))
        );
        column!(Int32Type, points.iter().map(|point| point.1), None);
        column!(
            DoubleType,
            points.iter().map(|point| point.2[0]),
            Some(levels(&|_| true))
        );
        column!(DoubleType, points.iter().map(|point| point.2[1]), None);
        let times = points.iter().filter_map(|point| point.3);
        column!(Int64Type, times, Some(levels(&|point| point.3.is_some())));
        rows.close().unwrap();
    }
    writer.close().unwrap();
}

/// Returns the rows of a file as names with values.
fn read(path: &Path) -> Vec<Vec<(String, Field)>> {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap();
    rows.map(|row| row.unwrap().into_columns()).collect()
}

fn points(count: usize) -> Vec<Point> {
    let mut random = fastrand::Rng::with_seed(3);
    (0..count)
        .map(|index| {
            let sequence = random.i32(1..=4);
            let place = [(); 2].map(|()| 80.0 * (random.f64() - 0.5));
            let name = (index % 3 != 1).then_some(["a", "b,c", ""][index % 3]);
            (
                name,
                sequence,
                place,
                (index % 5 != 0).then_some(17_000_000),
            )
        })
        .collect()
}

#[test]
fn rows_of_all_groups_keep_their_columns_and_have_the_numbers_of_the_text() {
    let flight = flight();
    let points = points(20_000);
    let path = |name: &str| flight.bench.path(name);
    write(&path("points.parquet"), &points, 7_001, Compression::SNAPPY);
    let mut text = String::from("sequence,x_mm,y_mm\n");
    for (_, sequence, [x, y], _) in &points {
        text.push_str(&[sequence.to_string(), x.to_string(), y.to_string()].join(","));
        text.push('\n');
    }
    fs::write(path("points.csv"), text).unwrap();
    let run = |more: &[&str]| {
        let arguments = [&["correct"], &RECORDS[..], more].concat();
        flight.bench.run(&arguments).ok().stdout
    };
    run(&["points.parquet", "--out", "answer.parquet"]);
    let csv = run(&["points.csv"]);
    let mut csv = csv::Reader::from_reader(csv.as_bytes());
    let answer = read(&path("answer.parquet"));
    assert_eq!(answer.len(), points.len());
    let names: Vec<&str> = answer[0].iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[..5], ["name", "sequence", "x_mm", "y_mm", "taken"]);
    assert_eq!(names[5..], ["dx_um", "dy_um", "sigma_x_um", "sigma_y_um"]);
    for ((row, expected), point) in answer.iter().zip(csv.records()).zip(&points) {
        let expected = expected.unwrap();
        let name = point
            .0
            .map_or(Field::Null, |name| Field::Str(name.to_owned()));
        assert_eq!(row[0].1, name);
        assert_eq!(row[1].1, Field::Int(point.1));
        let time = point.3.map_or(Field::Null, Field::TimestampMicros);
        assert_eq!(row[4].1, time);
        for (place, cell, decimals) in [
            (2, 1, 9),
            (3, 2, 9),
            (5, 3, 6),
            (6, 4, 6),
            (7, 5, 6),
            (8, 6, 6),
        ] {
            let Field::Double(number) = row[place].1 else {
                panic!("{row:?}");
            };
            assert_eq!(format!("{:.decimals$}", number + 0.0), expected[cell]);
        }
    }
    // Columns of an earlier answer are replaced.
    let back = ["distort", "answer.parquet", "--out", "back.parquet"];
    flight.bench.run(&[&back[..], &RECORDS].concat()).ok();
    let back = read(&path("back.parquet"));
    assert_eq!(back[0].len(), 9);
    for (row, point) in back.iter().zip(&points) {
        let Field::Double(x) = row[2].1 else {
            panic!("{row:?}");
        };
        assert!((x - point.2[0]).abs() < 1.2e-5);
    }
}

#[test]
fn points_without_an_answer_are_left_out_or_marked() {
    let flight = flight();
    let points = [
        (Some("a"), 1, [1.0, 2.0], None),
        (None, i32::try_from(REFUSED).unwrap(), [1.0, 2.0], Some(1)),
        (Some("c"), 2, [50.0, 2.0], Some(2)),
        (None, 3, [3.0, 4.0], Some(3)),
    ];
    write(
        &flight.bench.path("points.parquet"),
        &points,
        9,
        Compression::UNCOMPRESSED,
    );
    let run = |more: &[&str]| {
        let arguments = [&["correct", "points.parquet"], &RECORDS[..], more].concat();
        flight.bench.run(&arguments)
    };
    run(&[]).refused(&["points.parquet, row 1: frame 5: its trigger was refused (not at speed)"]);
    run(&["--off-sensor", "skip", "--out", "answer.parquet"]).ok();
    let skipped = read(&flight.bench.path("answer.parquet"));
    let column = |rows: &[Vec<(String, Field)>], place: usize| -> Vec<Field> {
        rows.iter().map(|row| row[place].1.clone()).collect()
    };
    assert_eq!(
        column(&skipped, 0),
        [Field::Str("a".to_owned()), Field::Null]
    );
    assert_eq!(
        column(&skipped, 4),
        [Field::Null, Field::TimestampMicros(3)]
    );
    run(&["--off-sensor", "flag", "--out", "answer.parquet"]).ok();
    let marked = read(&flight.bench.path("answer.parquet"));
    let flags = ["", "refused: not at speed", "off sensor", ""];
    assert_eq!(
        column(&marked, 9),
        flags.map(|flag| Field::Str(flag.to_owned()))
    );
    assert!(matches!(marked[1][2].1, Field::Double(x) if x.is_nan()));
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let flight = flight();
    let path = flight.bench.path("points.parquet");
    let refused = |more: &[&str], words: &[&str]| {
        let arguments = [&["correct"], &RECORDS[..], more].concat();
        flight.bench.run(&arguments).refused(words);
    };
    write(&path, &points(2_000), 500, Compression::SNAPPY);
    let whole = fs::read(&path).unwrap();
    for length in [0, 3, 12, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        refused(
            &["points.parquet"],
            &["points.parquet is not a file of Parquet that can be read"],
        );
    }
    let mut damaged = whole.clone();
    for byte in &mut damaged[200..2_000] {
        *byte ^= 0x5a;
    }
    fs::write(&path, damaged).unwrap();
    refused(&["points.parquet"], &["points.parquet"]);
    write(&path, &[(None, 9, [0.0; 2], None)], 1, Compression::SNAPPY);
    refused(
        &["points.parquet"],
        &["points.parquet, row 0: sequence = 9: records.csv has no such frame"],
    );
    refused(
        &["-", "--format", "parquet"],
        &["cannot be read from standard input"],
    );
    let exposure = [
        "--camera",
        "camera.toml",
        "--vh",
        "0.1",
        "--exposure",
        "1/200",
    ];
    let single = [&["correct", "points.parquet"], &exposure[..]].concat();
    flight
        .bench
        .run(&single)
        .refused(&["Parquet is for the points of --records and --frames"]);
}
