//! Frames of a flight whose camera has residual grids of lens and sensor.

use std::fmt::Write as _;
use std::fs;

use fmc_camera::geometry::sensor::SensorPoint;
use fmc_reference::residual_splines::ResidualSplines;
use serde_json::Value;

use super::flight::{Flight, RECORDS, REFUSED, flight, flight_with};
use crate::command_line::support::{Bench, CAMERA};
use crate::command_line::wave_grid::{Lattice, WaveGrids};

/// Covers the sensor of the test camera and its stroke.
const LATTICE: Lattice = Lattice {
    nodes: 48,
    pitch_mm: 2.0,
};

/// A flight with grids of 4 µm, and the grids in double precision.
fn gridded() -> (Flight, ResidualSplines) {
    let grids = WaveGrids::new(4.0, LATTICE);
    let flight = flight_with(&format!("{CAMERA}{}", grids.table), &grids.files());
    (flight, grids.splines())
}

/// Points of every exposure, frame by frame.
fn points() -> Vec<(usize, [f32; 2])> {
    let mut random = fastrand::Rng::with_seed(5);
    let frames = (1..=8).filter(|one| *one != REFUSED as usize);
    frames
        .flat_map(|frame| (0..60).map(move |_| frame))
        .map(|frame| (frame, [0, 1].map(|_| 76.0 * (random.f32() - 0.5))))
        .collect()
}

fn text(points: &[(usize, [f32; 2])]) -> String {
    let mut text = String::from("sequence,x_mm,y_mm\n");
    for (frame, [x, y]) in points {
        writeln!(text, "{frame},{},{}", f64::from(*x), f64::from(*y)).unwrap();
    }
    text
}

/// Returns `x_mm`, `y_mm`, `dx_um` and `dy_um` of every row of an answer.
fn answers(bench: &Bench, command: &str, records: &str, points: &str) -> Vec<[f64; 4]> {
    fs::write(bench.path("points.csv"), points).unwrap();
    let camera = [command, "--camera", "camera.toml", "--records", records];
    let answer = bench.run(&[&camera[..], &["points.csv"]].concat()).ok();
    let mut rows = csv::Reader::from_reader(answer.stdout.as_bytes());
    let header = rows.headers().unwrap().clone();
    let places = ["x_mm", "y_mm", "dx_um", "dy_um"]
        .map(|name| header.iter().position(|one| one == name).unwrap());
    let cells = |row: csv::StringRecord| places.map(|place| row[place].parse().unwrap());
    rows.records().map(|row| cells(row.unwrap())).collect()
}

/// The grid of the lens goes with the principal point of every record, that of the sensor stays.
#[test]
fn points_of_records_are_corrected_with_the_grids_at_the_place_of_their_frame() {
    let (flight, grids) = gridded();
    let points = points();
    let found = answers(&flight.bench, "correct", "records.csv", &text(&points));
    assert_eq!(found.len(), points.len());
    assert_eq!(
        answers(&flight.bench, "correct", "records.json", &text(&points)),
        found
    );
    let (mut largest, mut moved) = (0.0_f64, 0.0_f64);
    for ((frame, [x, y]), [.., dx_um, dy_um]) in points.iter().zip(&found) {
        let polynomial = flight.corrections[frame - 1].distortion(SensorPoint::new(*x, *y));
        let motion = [0.0, f64::from(flight.centroids_mm[frame - 1])];
        let enlargement = f64::from(flight.enlargements[frame - 1]);
        let point = [*x, *y].map(f64::from);
        let added = grids.moved(point, motion, enlargement);
        let at_rest = grids.calibrated(point);
        let polynomial = [polynomial.dx_mm, polynomial.dy_mm].map(f64::from);
        for (axis, um) in [dx_um, dy_um].into_iter().enumerate() {
            let expected_nm = 1e6 * (polynomial[axis] + added[axis]);
            largest = largest.max((1e3 * um - expected_nm).abs());
            moved = moved.max(1e6 * (added[axis] - at_rest[axis]).abs());
        }
    }
    // Either grid is within 0.1 nm of double precision; single precision of 60 µm takes the rest.
    assert!(largest < 0.3, "{largest} nm");
    // 0.3 mm of motion over a slope of 2e-3.
    assert!(moved > 200.0, "{moved} nm");
}

#[test]
fn distort_of_records_takes_back_what_correct_answers() {
    let (flight, _) = gridded();
    let points = points();
    let ideal = answers(&flight.bench, "correct", "records.csv", &text(&points));
    let mut again = String::from("sequence,x_mm,y_mm\n");
    for ((frame, _), [x, y, ..]) in points.iter().zip(&ideal) {
        writeln!(again, "{frame},{x:.9},{y:.9}").unwrap();
    }
    let found = answers(&flight.bench, "distort", "records.csv", &again);
    assert_eq!(found.len(), points.len());
    for ((_, measured), [x, y, ..]) in points.iter().zip(&found) {
        for (found, measured) in [x, y].into_iter().zip(measured) {
            // Units in the last place of 40 mm: 4 nm each.
            assert!((found - f64::from(*measured)).abs() < 1.2e-5, "{found}");
        }
    }
}

#[test]
fn frames_of_records_state_what_the_grids_leave_out_and_are_no_others() {
    let column = |flight: &Flight, name: &str| -> Vec<String> {
        let answer = flight.bench.run(&[&["frame"], &RECORDS[..]].concat()).ok();
        let mut rows = csv::Reader::from_reader(answer.stdout.as_bytes());
        let place = rows.headers().unwrap().iter().position(|one| one == name);
        let place = place.unwrap_or_else(|| panic!("{name}"));
        let rows = rows.records().map(|row| row.unwrap()[place].to_owned());
        rows.collect()
    };
    let (gridded, _) = gridded();
    let plain = flight();
    for name in ["principal_point_y_mm", "enlargement", "outcome"] {
        assert_eq!(column(&gridded, name), column(&plain, name), "{name}");
    }
    let left_out = |flight: &Flight| column(flight, "left_out_nm");
    let pairs = left_out(&gridded).into_iter().zip(left_out(&plain));
    let mut compared = 0;
    for (gridded, plain) in pairs.filter(|(one, _)| !one.is_empty()) {
        let [gridded, plain] = [gridded, plain].map(|text| text.parse::<f64>().unwrap());
        assert!(gridded > 1.2 * plain, "{gridded} {plain}");
        compared += 1;
    }
    assert_eq!(compared, 7);
    // Without its grids it is another camera.
    fs::write(gridded.bench.path("camera.toml"), CAMERA).unwrap();
    fs::write(gridded.bench.path("points.csv"), text(&points())).unwrap();
    for command in ["frame", "correct", "export"] {
        let mut arguments = vec![command];
        if command == "export" {
            arguments.push("frames");
        }
        arguments.extend(RECORDS);
        match command {
            "correct" => arguments.push("points.csv"),
            "export" => arguments.extend(["--out", "out"]),
            _ => {}
        }
        gridded
            .bench
            .run(&arguments)
            .refused(&["calibration_crc32", "another calibration than camera.toml"]);
    }
    assert!(!gridded.bench.path("out").exists());
}

#[test]
fn certificate_of_the_gridded_camera_knows_its_records_and_no_others() {
    let (gridded, _) = gridded();
    let bench = &gridded.bench;
    let make = ["certificate", "--camera", "camera.toml", "--out", "out"];
    bench.run(&make).ok();
    for records in ["records.csv", "records.json"] {
        let check = ["certificate", "check", "out", "--records", records];
        let answer = bench.run(&check).ok();
        assert!(answer.stdout.contains("all 8 records"), "{}", answer.stdout);
    }
    // The records of the same camera without grids.
    let plain = flight();
    for records in ["records.csv", "records.json"] {
        let other = format!("plain-{records}");
        fs::copy(plain.bench.path(records), bench.path(&other)).unwrap();
        let check = ["certificate", "check", "out", "--records", &other];
        let answer = bench.run(&check);
        assert_eq!(answer.code, 1, "{}", answer.stdout);
        assert!(
            answer.stderr.contains("8 with") && answer.stderr.contains("the first is 1"),
            "{}",
            answer.stderr
        );
    }
}

fn statement(bench: &Bench, folder: &str) -> Value {
    let path = bench.path(&format!("{folder}/export.json"));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Returns the statement of an export of a flight's frames, with `--out` of the format's name.
fn exported(flight: &Flight, format: &str) -> Value {
    let arguments = ["export", format, "--out", format];
    let answer = flight.bench.run(&[&arguments[..], &RECORDS].concat());
    answer.ok();
    statement(&flight.bench, format)
}

fn largest_um(statement: &Value) -> f64 {
    statement["residual_max_um"].as_f64().unwrap()
}

/// Files of other programs hold the polynomial; what the grids leave in the frames is stated.
#[test]
fn exports_of_records_state_what_the_grids_leave_in_the_frames() {
    let (gridded, _) = gridded();
    let plain = flight();
    for format in ["colmap", "metashape", "opensfm", "opf", "opentrackio"] {
        let (with, without) = (exported(&gridded, format), exported(&plain, format));
        assert_eq!(with["frames"]["exposures"], 7, "{format}");
        assert_eq!(with["files"], without["files"], "{format}");
        let states =
            |statement: &Value| statement["not_held"].to_string().contains("residual grids");
        assert!(states(&with) && !states(&without), "{format}: {with}");
        // Waves of 4 µm in lens and sensor.
        let added = largest_um(&with) - largest_um(&without);
        assert!((3.0..12.0).contains(&added), "{format}: {added}");
        fs::remove_dir_all(gridded.bench.path(format)).unwrap();
        let arguments = ["export", format, "--out", format, "--max-residual-um", "2"];
        let answer = gridded.bench.run(&[&arguments[..], &RECORDS].concat());
        assert_eq!(answer.code, 1, "{format}: {}", answer.stderr);
        assert!(!gridded.bench.path(format).exists(), "{format}");
    }
}

/// Tables without coefficients go with points that `correct` has corrected, grids included.
#[test]
fn tables_of_frames_without_coefficients_leave_the_grids_to_correct() {
    let (gridded, _) = gridded();
    for format in ["arcgis", "frames"] {
        let statement = exported(&gridded, format);
        assert_eq!(largest_um(&statement).to_bits(), 0, "{format}");
        let advice = statement["advice"].to_string();
        assert!(advice.contains("corrected"), "{format}: {advice}");
    }
}
