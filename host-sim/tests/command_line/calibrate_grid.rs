//! `calibrate grid`.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

use crate::command_line::calibration_files::{assert_complete, parameter, summary};
use crate::command_line::support::{Answer, Bench};

/// Columns of a table.
const COLUMNS: &str = "x_mm,y_mm,dx_um,dy_um,stage_offset_mm\n";

/// Waves of the lens: amplitude and length, mm.
const WAVES: [f64; 2] = [3e-3, 20.0];

/// Structure of the lens or, at another phase, of the sensor, mm.
fn waves([x, y]: [f64; 2], [amplitude, length]: [f64; 2], phase: f64) -> [f64; 2] {
    let wave = |along: f64, phase: f64| amplitude * (TAU * along / length + phase).sin();
    [
        wave(0.4 * x - 0.9 * y, phase),
        wave(0.8 * x + 0.6 * y, 2.0 * phase),
    ]
}

/// Distortion of the simulated lens at a measured point, mm; the stage leaves its plane by 1 µm per
/// mm, as the camera file says.
fn distortion([x, y]: [f64; 2], offset: f64, size: [f64; 2]) -> [f64; 2] {
    let enlargement = 1e-3 * offset / 110.0;
    let [px, py] = [x - 0.02, y + 0.01 - offset].map(|place| place / (1.0 + enlargement));
    let r2 = px * px + py * py;
    let radial = -1.1e-6 * r2 + 2e-10 * r2 * r2;
    let [wx, wy] = waves([px + 0.02, py - 0.01], size, 0.4);
    [
        enlargement * px + px * radial + wx,
        enlargement * py + py * radial + wy,
    ]
}

/// Rows of a table of 61 x 61 points.
fn rows(offset: f64, size: [f64; 2], of_sensor: f64) -> String {
    let mut text = String::new();
    for (column, row) in (0..61_u8).flat_map(|row| (0..61_u8).map(move |column| (column, row))) {
        let point = [column, row].map(|place| 1.34 * (f64::from(place) - 30.0));
        let [dx, dy] = distortion(point, offset, size);
        let [sx, sy] = waves(point, [of_sensor, 20.0], 1.9);
        let [x, y] = point;
        let [dx, dy] = [1e3 * (dx + sx), 1e3 * (dy + sy)];
        let _ = writeln!(text, "{x:.6},{y:.6},{dx:.9},{dy:.9},{offset}");
    }
    text
}

fn table(offset: f64, size: [f64; 2]) -> String {
    format!("{COLUMNS}{}", rows(offset, size, 0.0))
}

fn run(bench: &Bench, table: &str, more: &[&str]) -> Answer {
    fs::write(bench.path("table.csv"), table).unwrap();
    let arguments = ["calibrate", "grid", "table.csv", "--camera", "camera.toml"];
    bench.run(&[&arguments, more].concat())
}

/// Largest error of the corrected points of a camera between the rows of its table, nm.
fn largest_error_nm(bench: &Bench, camera: &str) -> f64 {
    let mut points = String::from("id,x_mm,y_mm\n");
    for index in 0..400_u32 {
        let [x, y] = [index % 20, index / 20].map(|place| 4.03 * (f64::from(place) - 9.5));
        let _ = writeln!(points, "{index},{x:.6},{y:.6}");
    }
    fs::write(bench.path("points.csv"), points).unwrap();
    let more = ["--vh", "0.1", "--exposure", "1/200", "--model", "static"];
    let arguments = [&["correct", "--camera", camera][..], &more, &["points.csv"]].concat();
    let answer = bench.run(&arguments).ok();
    let mut largest = 0.0_f64;
    for row in csv::Reader::from_reader(answer.stdout.as_bytes()).records() {
        let row = row.unwrap();
        let index: u32 = row[0].parse().unwrap();
        let point = [index % 20, index / 20].map(|place| 4.03 * (f64::from(place) - 9.5));
        let truth = distortion(point, 0.0, WAVES);
        for axis in 0..2 {
            // Columns x_mm, y_mm, dx_um, dy_um.
            let found: f64 = row[3 + axis].parse().unwrap();
            largest = largest.max(1e3 * (found - 1e3 * truth[axis]).abs());
        }
    }
    largest
}

#[test]
fn camera_with_its_grid_corrects_within_thirteen_nanometres() {
    let bench = Bench::new();
    let more = ["--pitch-mm", "2", "--out", "out", "--date", "2026-03-14"];
    let answer = run(&bench, &table(0.0, WAVES), &more).ok();
    assert_complete(&bench, &answer, "out");
    for name in ["left-by-polynomial.svg", "grid-lens.svg", "grid-lens.fmcg"] {
        assert!(bench.path(&format!("out/{name}")).exists(), "{name}");
    }
    let summary = summary(&bench, "out/summary.json");
    assert_eq!(summary["method"], "grid");
    let grid = &summary["grids"][0];
    assert_eq!(grid["frame"], "lens");
    assert_eq!(grid["columns"], 44);
    let bytes = fs::read(bench.path("out/grid-lens.fmcg")).unwrap();
    assert_eq!(grid["bytes"], bytes.len());
    let text = fs::read_to_string(bench.path("out/camera.toml")).unwrap();
    let crc32 = grid["crc32"].as_str().unwrap();
    assert!(
        text.contains(&format!("lens_crc32 = \"{crc32}\"")),
        "{text}"
    );
    assert!(summary["polynomial_alone"]["max_um"].as_f64().unwrap() > 2.0);
    assert!(summary["polynomial_and_grid"]["max_um"].as_f64().unwrap() < 0.013);
    // The coefficients of the camera file that are not estimated are kept.
    assert_eq!(parameter(&summary, "b1"), (1e-5, 0.0));
    let error = largest_error_nm(&bench, "out/camera.toml");
    assert!(error <= 13.0, "{error} nm");
    // A camera that has a grid already is calibrated anew.
    fs::copy(bench.path("out/camera.toml"), bench.path("camera.toml")).unwrap();
    fs::remove_file(bench.path("out/grid-lens.fmcg")).unwrap();
    run(
        &bench,
        &table(0.0, WAVES),
        &["--pitch-mm", "2", "--out", "again"],
    )
    .ok();
    let error = largest_error_nm(&bench, "again/camera.toml");
    assert!(error <= 13.0, "{error} nm");
}

#[test]
fn three_stage_offsets_give_both_grids_and_a_later_run_leaves_no_stale_one() {
    let bench = Bench::new();
    let mut text = COLUMNS.to_owned();
    for offset in [-1.5, 0.0, 1.5] {
        text += &rows(offset, WAVES, 2e-3);
    }
    let more = ["--pitch-mm", "2", "--out", "out", "--frame"];
    run(&bench, &text, &[&more[..], &["both"]].concat()).ok();
    let found = summary(&bench, "out/summary.json");
    assert_eq!(found["grids"][1]["frame"], "sensor");
    assert!(
        found["polynomial_and_grid"]["max_um"].as_f64().unwrap() < 0.013,
        "{}",
        found["polynomial_and_grid"]
    );
    let sensor = bench.path("out/grid-sensor.fmcg");
    assert!(sensor.exists());
    run(&bench, &text, &[&more[..], &["lens"]].concat()).ok();
    assert!(!sensor.exists());
    let found = summary(&bench, "out/summary.json");
    // One grid does not follow what moves and what does not.
    assert!(
        found["polynomial_and_grid"]["max_um"].as_f64().unwrap() > 0.3,
        "{}",
        found["polynomial_and_grid"]
    );
}

#[test]
fn grid_that_folds_the_image_leaves_reports_and_no_camera() {
    let bench = Bench::new();
    let more = ["--pitch-mm", "2", "--out", "out"];
    run(&bench, &table(0.0, WAVES), &more).ok();
    let answer = run(&bench, &table(0.0, [0.1, 10.0]), &more);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(
        answer.stderr.contains("[grid]") && answer.stderr.contains("slope"),
        "{}",
        answer.stderr
    );
    for name in ["camera.toml", "grid-lens.fmcg"] {
        assert!(!bench.path(&format!("out/{name}")).exists(), "{name}");
    }
    let warnings = summary(&bench, "out/summary.json")["warnings"].to_string();
    assert!(warnings.contains("no usable camera"), "{warnings}");
}

#[test]
fn wrong_tables_and_pitches_are_refused_by_name() {
    let bench = Bench::new();
    let good = table(0.0, WAVES);
    let refused = |text: &str, more: &[&str], words: &[&str]| {
        run(&bench, text, &[&["--out", "out"], more].concat()).refused(words);
        assert!(!bench.path("out").exists());
    };
    let pitch = ["--pitch-mm", "2"];
    refused(
        &good,
        &[&pitch[..], &["--frame", "both"]].concat(),
        &["one stage position", "0 mm"],
    );
    refused(
        &good,
        &["--pitch-mm", "0.5"],
        &["pitch 0.5 mm", "at most 4096", "mm and more"],
    );
    refused(&good, &["--pitch-mm", "0"], &["--pitch-mm"]);
    refused(
        &good,
        &[&pitch[..], &["--estimate", "k4"]].concat(),
        &["k4", "k0, k1"],
    );
    let without = good.replace("dy_um", "dy");
    refused(&without, &pitch, &["line 1", "dy_um is missing"]);
    let text = good.replacen("-40.200000", "-140.2", 1);
    refused(&text, &pitch, &["line 2", "x_mm", "-140.2"]);
    let mut lines: Vec<&str> = good.lines().collect();
    lines[7] = "1,2,oops,3,0";
    refused(&lines.join("\n"), &pitch, &["line 8", "dx_um", "oops"]);
    lines[7] = "1,2,0,0,2.5";
    refused(
        &lines.join("\n"),
        &pitch,
        &["line 8", "stage_offset_mm", "2.5", "-2 to 2"],
    );
    refused(COLUMNS, &pitch, &["table.csv", "0 rows", "16 and more"]);
}
