//! `import --grid`: what the polynomial leaves of another program's model.

use std::fmt::Write as _;
use std::fs;

use crate::command_line::exchange::{FILES, IXM, json};
use crate::command_line::support::Bench;

/// Files of programs whose model the polynomial of a camera file does not hold, each with the
/// options that it needs.
fn others(bench: &Bench) -> Vec<(String, String)> {
    let mut files = Vec::new();
    for (format, names) in FILES {
        for model in models(format) {
            let folder = format!("{format}{model}");
            let out = ["--camera", "camera.toml", "--out", &folder];
            let model: &[&str] = match *model {
                "" => &[],
                model => &["--model", model],
            };
            let export = [&["export", format], &out[..], model].concat();
            bench.run(&export).ok();
            files.push((format.to_owned(), format!("{folder}/{}", names[0])));
        }
    }
    files
}

fn models(format: &str) -> &'static [&'static str] {
    match format {
        "opencv" => &["opencv5", "opencv8", "opencv14"],
        "colmap" => &["RADIAL", "OPENCV", "FULL_OPENCV"],
        _ => &[""],
    }
}

#[test]
fn grid_takes_what_the_polynomial_leaves_of_every_format_within_5_nm() {
    let bench = Bench::with(IXM, b"");
    let mut grids = 0;
    for (number, (format, file)) in others(&bench).into_iter().enumerate() {
        let (out, report) = (format!("new{number}.toml"), format!("new{number}.json"));
        let import = ["import", &format, &file, "--base", "camera.toml", "--grid"];
        let files = ["--out", &out, "--report", &report];
        let answer = bench.run(&[&import[..], &files].concat()).ok();
        let report = json(&bench, &report);
        let left_um = report["residual_max_um"].as_f64().unwrap();
        assert!(left_um <= 0.005, "{file}: {left_um} µm");
        let text = fs::read_to_string(bench.path(&out)).unwrap();
        if report["grid"].is_null() {
            // The program's model is ours, or differs by less than a grid would leave.
            assert!(answer.stderr.contains("no grid is needed"), "{file}");
            assert!(!text.contains("[grid]"), "{text}");
            continue;
        }
        grids += 1;
        let alone = report["grid"]["polynomial_residual_max_um"].as_f64();
        assert!(alone.unwrap() > left_um, "{report}");
        let name = report["grid"]["file"].as_str().unwrap();
        assert!(
            text.contains("# Residual grid: ") && text.contains(name),
            "{text}"
        );
        let check = bench.run(&["camera-file", "check", &out]).ok();
        let crc = report["grid"]["crc32"].as_str().unwrap();
        assert!(check.stdout.contains(crc), "{}", check.stdout);
    }
    assert!(grids >= 9, "{grids}");
}

/// Sensor of a camera that is no published one.
const WIDTH_PX: f64 = 8000.0;
const HEIGHT_PX: f64 = 6000.0;
const PITCH_MM: f64 = 0.004;
const FOCAL_PX: [f64; 2] = [9000.0, 9001.5];
const CENTRE_PX: [f64; 2] = [4010.5, 2985.25];

/// Formula of `OpenCV` with denominator, decentring and thin prism, as its documentation has it.
fn opencv_pixel([x, y]: [f64; 2]) -> [f64; 2] {
    let r2 = x * x + y * y;
    let radial = (1.0 + r2 * (-0.09 + r2 * (0.06 + r2 * -0.02)))
        / (1.0 + r2 * (0.02 + r2 * (-0.01 + r2 * 0.004)));
    let (p1, p2) = (1.5e-4, -2.5e-4);
    let bent_x =
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + 1e-4 * r2 + 2e-5 * r2 * r2;
    let bent_y =
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y - 5e-5 * r2 + 3e-5 * r2 * r2;
    [
        FOCAL_PX[0] * bent_x + CENTRE_PX[0],
        FOCAL_PX[1] * bent_y + CENTRE_PX[1],
    ]
}

const OPENCV: &str = "%YAML:1.0\n---\nimage_width: 8000\nimage_height: 6000\n\
camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n\
\x20  data: [ 9000., 0., 4010.5, 0., 9001.5, 2985.25, 0., 0., 1. ]\n\
distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 12\n   dt: d\n\
\x20  data: [ -0.09, 0.06, 1.5e-4, -2.5e-4, -0.02, 0.02, -0.01, 0.004, 1e-4, 2e-5, -5e-5, 3e-5 ]\n";

#[test]
fn camera_with_an_imported_grid_corrects_as_the_program_does_within_5_nm() {
    let bench = Bench::with(IXM, b"");
    fs::write(bench.path("other.yaml"), OPENCV).unwrap();
    let import = [
        "import",
        "opencv",
        "other.yaml",
        "--pixel-um",
        "4",
        "--grid",
    ];
    bench
        .run(&[&import[..], &["--out", "new.toml"]].concat())
        .ok();
    // Rays to the corners of the sensor and between.
    let mut points = String::from("id,x_mm,y_mm\n");
    let mut expected = Vec::new();
    for (i, j) in (-5..=5).flat_map(|i| (-5..=5).map(move |j| (i, j))) {
        let ray = [0.082 * f64::from(i), 0.062 * f64::from(j)];
        let [column, row] = opencv_pixel(ray);
        let x = (column - 0.5 * (WIDTH_PX - 1.0)) * PITCH_MM;
        let y = (0.5 * (HEIGHT_PX - 1.0) - row) * PITCH_MM;
        assert!(x.abs() <= 16.0 && y.abs() <= 12.0, "({x}, {y}) mm");
        writeln!(points, "{i}/{j},{x:.9},{y:.9}").unwrap();
        let focal = FOCAL_PX[1] * PITCH_MM;
        let x0 = (CENTRE_PX[0] - 0.5 * (WIDTH_PX - 1.0)) * PITCH_MM;
        let y0 = (0.5 * (HEIGHT_PX - 1.0) - CENTRE_PX[1]) * PITCH_MM;
        expected.push([x - x0 - focal * ray[0], y - y0 + focal * ray[1]]);
    }
    fs::write(bench.path("points.csv"), points).unwrap();
    let exposure = [
        "--camera",
        "new.toml",
        "--vh",
        "0.01",
        "--exposure",
        "1/5000",
    ];
    let answer = bench
        .run(&[&["correct"], &exposure[..], &["points.csv"]].concat())
        .ok();
    let mut reader = csv::Reader::from_reader(answer.stdout.as_bytes());
    let headings = reader.headers().unwrap().clone();
    let column = |name: &str| headings.iter().position(|own| own == name).unwrap();
    let columns = [column("dx_um"), column("dy_um")];
    let mut largest_um = 0.0_f64;
    let mut compared = 0;
    for (row, expected) in reader.records().zip(&expected) {
        let row = row.unwrap();
        for (column, expected) in columns.into_iter().zip(expected) {
            let found: f64 = row[column].parse().unwrap();
            largest_um = largest_um.max((found - 1e3 * expected).abs());
            compared += 1;
        }
    }
    assert_eq!(compared, 242);
    assert!(largest_um <= 0.005, "{largest_um} µm");
}
