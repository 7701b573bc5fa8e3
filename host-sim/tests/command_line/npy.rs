//! Points and answers as arrays of NumPy.

use std::fs;
use std::io::Write as _;

use npyz::{NpyFile, Order, WriterBuilder as _};

use crate::command_line::support::{Answer, Bench, CAMERA, EXPOSURE};

fn array<T: npyz::AutoSerialize + Copy>(shape: &[u64], order: Order, numbers: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(shape)
        .order(order)
        .writer(&mut bytes)
        .begin_nd()
        .unwrap();
    writer.extend(numbers.iter().copied()).unwrap();
    writer.finish().unwrap();
    bytes
}

fn numbers<T: npyz::Deserialize>(path: &std::path::Path) -> (Vec<u64>, Vec<T>) {
    let file = NpyFile::new(fs::File::open(path).unwrap()).unwrap();
    let shape = file.shape().to_vec();
    (shape, file.into_vec().unwrap())
}

/// `command` on `points.npy`.
fn on_array(bench: &Bench, command: &str, points: &[u8], more: &[&str]) -> Answer {
    fs::write(bench.path("points.npy"), points).unwrap();
    bench.run(&[&[command][..], &EXPOSURE, more, &["points.npy"]].concat())
}

const POINTS: [f64; 6] = [10.0, -20.0, -40.32, 40.32, 0.0, 0.0];

#[test]
fn array_is_answered_by_an_array_with_the_numbers_of_the_text() {
    let bench = Bench::new();
    for command in ["correct", "distort", "reference"] {
        // A corner has no measured point: its ideal one lies inside.
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
            // The text is rounded at 1e-9 mm and 1e-6 µm.
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
        // Coordinates are those of the camera, in its own precision.
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
    refused(b"id,x_mm,y_mm\na,1,2\n", &["no array of NumPy"]);
    refused(b"", &["no array of NumPy"]);
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

#[test]
fn text_is_not_answered_by_an_array_whose_length_nobody_knows() {
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,2\n");
    bench
        .points("correct", &["--out", "out.npy"])
        .refused(&["npy needs points as npy", "points.csv"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
}
