//! Points and answers as arrays of NumPy.

use std::fs;
use std::io::Write as _;

use crate::command_line::support::{Answer, Bench, CAMERA, EXPOSURE};

/// Order of an array's numbers in the file.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    C,
    Fortran,
}

trait Number: Copy {
    const TYPE: &str;
    fn bytes(self) -> Vec<u8>;
    fn all(bytes: &[u8]) -> Vec<Self>;
}

macro_rules! number {
    ($number:ty, $name:literal) => {
        impl Number for $number {
            const TYPE: &str = $name;
            fn bytes(self) -> Vec<u8> {
                self.to_le_bytes().to_vec()
            }
            fn all(bytes: &[u8]) -> Vec<Self> {
                let (numbers, rest) = bytes.as_chunks();
                assert!(rest.is_empty());
                numbers.iter().copied().map(Self::from_le_bytes).collect()
            }
        }
    };
}

number!(f32, "<f4");
number!(f64, "<f8");
number!(i32, "<i4");

/// Length of a header of version 1.0 as NumPy pads it, bytes.
const HEADER: usize = 128;

/// Returns an array as `numpy.save` writes it.
fn array<T: Number>(shape: &[u64], order: Order, numbers: &[T]) -> Vec<u8> {
    let axes: Vec<String> = shape.iter().map(u64::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let text = format!(
        "{{'descr': '{}', 'fortran_order': {}, 'shape': ({}{comma}), }}",
        T::TYPE,
        if order == Order::C { "False" } else { "True" },
        axes.join(", ")
    );
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(text.as_bytes());
    bytes.resize(HEADER - 1, b' ');
    bytes.push(b'\n');
    bytes.extend(numbers.iter().flat_map(|number| number.bytes()));
    bytes
}

/// Returns shape and numbers of an answer, whose header is checked byte by byte.
fn numbers<T: Number>(path: &std::path::Path) -> (Vec<u64>, Vec<T>) {
    let bytes = fs::read(path).unwrap();
    let (header, numbers) = bytes.split_at(HEADER);
    let (before, text) = header.split_at(10);
    assert_eq!(before, b"\x93NUMPY\x01\x00\x76\x00");
    let text = str::from_utf8(text).unwrap().strip_suffix('\n').unwrap();
    let start = format!(
        "{{'descr': '{}', 'fortran_order': False, 'shape': (",
        T::TYPE
    );
    let axes = text.trim_end().strip_prefix(&start).unwrap();
    let axes = axes.strip_suffix(", ), }").unwrap().split(", ");
    let shape = axes.map(|axis| axis.parse().unwrap()).collect();
    (shape, T::all(numbers))
}

/// Runs `command` on `points.npy`.
fn on_array(bench: &Bench, command: &str, points: &[u8], more: &[&str]) -> Answer {
    fs::write(bench.path("points.npy"), points).unwrap();
    bench.run(&[&[command][..], &EXPOSURE, more, &["points.npy"]].concat())
}

const POINTS: [f64; 6] = [10.0, -20.0, -40.32, 40.32, 0.0, 0.0];

#[test]
fn array_is_answered_by_an_array_with_the_numbers_of_the_text() {
    let bench = Bench::new();
    for command in ["correct", "distort", "reference"] {
        // An ideal point in a corner has no measured point on the sensor, so the points stay
        // inside.
        let points: Vec<f64> = POINTS.iter().map(|number| number * 0.9).collect();
        let text = format!(
            "id,x_mm,y_mm\n0,{},{}\n1,{},{}\n2,{},{}\n",
            points[0], points[1], points[2], points[3], points[4], points[5]
        );
        fs::write(bench.path("points.csv"), text).unwrap();
        let rows = bench.points(command, &[]).ok().rows();
        on_array(
            &bench,
            command,
            &array(&[3, 2], Order::C, &points),
            &["--out", "out.npy"],
        )
        .ok();
        let (shape, found) = numbers::<f64>(&bench.path("out.npy"));
        assert_eq!(shape, [3, 4]);
        for (found, (_, expected)) in found.chunks(4).zip(rows) {
            // The text is rounded to 1e-9 mm and 1e-6 µm.
            assert!(
                (found[0] - expected[0]).abs() < 0.51e-9
                    && (found[1] - expected[1]).abs() < 0.51e-9
            );
            assert!(
                (found[2] - expected[2]).abs() < 0.51e-6
                    && (found[3] - expected[3]).abs() < 0.51e-6
            );
        }
    }
}

#[test]
fn single_precision_is_answered_in_single_precision_with_the_bits_of_the_camera() {
    let bench = Bench::new();
    let points: Vec<f32> = (0_u16..40_000)
        .flat_map(|row| {
            [
                f32::from(row % 8000) * 0.01 - 40.0,
                f32::from(row % 7919) * 0.01 - 39.5,
            ]
        })
        .collect();
    on_array(
        &bench,
        "correct",
        &array(&[40_000, 2], Order::C, &points),
        &["--out", "single.npy"],
    )
    .ok();
    let doubles: Vec<f64> = points.iter().map(|number| f64::from(*number)).collect();
    on_array(
        &bench,
        "correct",
        &array(&[40_000, 2], Order::C, &doubles),
        &["--out", "double.npy"],
    )
    .ok();
    let (shape, single) = numbers::<f32>(&bench.path("single.npy"));
    let (_, double) = numbers::<f64>(&bench.path("double.npy"));
    assert_eq!(shape, [40_000, 4]);
    for (single, double) in single.chunks(4).zip(double.chunks(4)) {
        // Coordinates have the bits of the camera, in its single precision.
        for axis in 0..2 {
            assert_eq!(f64::from(single[axis]).to_bits(), double[axis].to_bits());
        }
        for axis in 2..4 {
            // Half a unit in the last place of a distortion below 128 µm: 4e-6 µm.
            assert!((f64::from(single[axis]) - double[axis]).abs() < 4e-6);
        }
    }
}

#[test]
fn array_is_answered_as_text_where_the_answers_name_or_the_format_says_so() {
    let bench = Bench::new();
    let points = array(&[3, 2], Order::C, &POINTS);
    on_array(&bench, "correct", &points, &["--out", "out.csv"]).ok();
    let text = fs::read_to_string(bench.path("out.csv")).unwrap();
    let plain = bench.points("correct", &[]).ok().stdout;
    let by_name = plain
        .replace("\na,", "\n0,")
        .replace("\nb,", "\n1,")
        .replace("\nc,", "\n2,");
    assert_eq!(text, by_name);
    let answer = on_array(&bench, "correct", &points, &["--format", "csv"]).ok();
    assert_eq!(answer.stdout, by_name);
}

#[test]
fn empty_array_is_answered_by_an_empty_array() {
    let bench = Bench::new();
    on_array(
        &bench,
        "correct",
        &array::<f32>(&[0, 2], Order::C, &[]),
        &["--out", "out.npy"],
    )
    .ok();
    let (shape, found) = numbers::<f32>(&bench.path("out.npy"));
    assert_eq!(shape, [0, 4]);
    assert!(found.is_empty());
}

#[test]
fn arrays_that_are_no_points_are_refused_with_what_they_are() {
    let bench = Bench::new();
    let refused = |points: &[u8], words: &[&str]| {
        let answer = on_array(&bench, "correct", points, &["--out", "out.npy"]);
        answer.refused(words);
        answer.refused(&["points.npy"]);
        assert!(!bench.path("out.npy").exists());
    };
    refused(
        &array(&[2, 3], Order::C, &POINTS),
        &["shape [2, 3]", "(N, 2)"],
    );
    refused(&array(&[6], Order::C, &POINTS), &["shape [6]"]);
    refused(&array(&[3, 2], Order::Fortran, &POINTS), &["Fortran"]);
    refused(
        &array(&[3, 2], Order::C, &[1_i32; 6]),
        &["i4", "<f4 or <f8"],
    );
    refused(b"id,x_mm,y_mm\na,1,2\n", &["not an array of NumPy"]);
    refused(b"", &["not an array of NumPy"]);
    refused(
        &array(&[3, 2], Order::C, &[1.0, 2.0, 3.0, f64::NAN, 5.0, 6.0]),
        &["row 1", "NaN"],
    );
    refused(
        &array(&[3, 2], Order::C, &[1.0, 2.0, 3.0, 4.0, f64::INFINITY, 6.0]),
        &["row 2", "inf"],
    );
    refused(
        &array(&[3, 2], Order::C, &[1.0, 2.0, 3.0, 4.0, 5.0, 40.33]),
        &["row 2", "off the sensor", "40.32"],
    );
    let whole = array(&[3, 2], Order::C, &POINTS);
    refused(&whole[..whole.len() - 1], &["ends before the 3 rows"]);
    let mut longer = whole.clone();
    longer.write_all(&[0]).unwrap();
    refused(&longer, &["goes on behind the 3 rows"]);
}

/// Arrays written by NumPy 2: `a = arange(6, dtype='<f8').reshape(3, 2)`,
/// `format.write_array(file, a, version=...)`, and `save` of `a.astype('<f4')`, `a.astype('>f8')`,
/// `asfortranarray(a)` and of two numbers in a record.
const BY_NUMPY: [(&str, &[u8]); 7] = [
    ("version 1", include_bytes!("numpy/f8-version-1.npy")),
    ("version 2", include_bytes!("numpy/f8-version-2.npy")),
    ("version 3", include_bytes!("numpy/f8-version-3.npy")),
    ("single", include_bytes!("numpy/f4.npy")),
    ("big-endian", include_bytes!("numpy/big-endian.npy")),
    ("Fortran", include_bytes!("numpy/fortran.npy")),
    ("record", include_bytes!("numpy/record.npy")),
];

#[test]
fn arrays_that_numpy_wrote_are_answered_or_refused_with_what_they_are() {
    let bench = Bench::new();
    let points: Vec<f64> = (0..6).map(f64::from).collect();
    let [one, two, three, single, big_endian, fortran, record] = BY_NUMPY.map(|(_, file)| file);
    assert_eq!(one, array(&[3, 2], Order::C, &points));
    on_array(&bench, "correct", one, &["--out", "one.npy"]).ok();
    let expected = fs::read(bench.path("one.npy")).unwrap();
    for version in [two, three] {
        on_array(&bench, "correct", version, &["--out", "out.npy"]).ok();
        assert!(fs::read(bench.path("out.npy")).unwrap() == expected);
        fs::remove_file(bench.path("out.npy")).unwrap();
    }
    on_array(&bench, "correct", single, &["--out", "single.npy"]).ok();
    assert_eq!(numbers::<f32>(&bench.path("single.npy")).0, [3, 4]);
    for (array, word) in [
        (big_endian, "type '>f8'"),
        (fortran, "in Fortran order"),
        (record, "type [('x', '<f4'), ('y', '<f4')]"),
    ] {
        let answer = on_array(&bench, "correct", array, &["--out", "out.npy"]);
        answer.refused(&["points.npy", word, "<f4 or <f8"]);
    }
}

#[test]
fn damaged_headers_are_refused_with_the_file_and_what_is_wrong() {
    let bench = Bench::new();
    let whole = array(&[3, 2], Order::C, &POINTS);
    let with = |old: &str, new: &str| {
        let text = str::from_utf8(&whole[10..HEADER]).unwrap();
        assert!(text.contains(old));
        let text = text.replace(old, new);
        let length = u16::try_from(text.len()).unwrap().to_le_bytes();
        [&whole[..8], &length, text.as_bytes(), &whole[HEADER..]].concat()
    };
    let huge = [&b"\x93NUMPY\x02\x00\xff\xff\xff\xff"[..], &whole[10..]].concat();
    for (array, words) in [
        (whole[..100].to_vec(), "ends within its header"),
        (huge, "4294967295 bytes"),
        (with("(3, 2)", "(-3, 2)"), "length -3"),
        (
            with("(3, 2)", "(18446744073709551616, 2)"),
            "more than 64 bits",
        ),
        (with("}", "'order': 'C'}"), "\"order\""),
        (with("'fortran_order': False, ", ""), "\"fortran_order\""),
        (with("}", ""), "a string is missing"),
    ] {
        let answer = on_array(&bench, "correct", &array, &["--out", "out.npy"]);
        answer.refused(&["points.npy", "not an array of NumPy", words]);
        assert!(!bench.path("out.npy").exists());
    }
}

#[test]
fn text_is_not_answered_by_an_array_whose_length_nobody_knows() {
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,2\n");
    bench
        .points("correct", &["--out", "out.npy"])
        .refused(&["npy needs points as npy", "points.csv"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
}
