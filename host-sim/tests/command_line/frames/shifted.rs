//! Shifted points against the strict solver.

use std::fmt::Write as _;
use std::fs;

use fmc_camera_file::CameraFile;
use fmc_camera_file::published::CAMERA_FILES;
use fmc_reference::exposure::{ExposureRequest, FocusFormula};
use fmc_reference::lens::Lens;
use fmc_reference::strict::{Reading, StrictSolver, Weight};
use fmc_reference::verification::grid;

use crate::command_line::support::Bench;

/// Largest error of ideal points with one camera without distortion, per axis, nm: of a format of
/// 53 mm, and of one of 230 mm. Rounding of the coordinates to single precision is 1.9 and 3.8 nm.
const LARGEST_NM: [f64; 2] = [2.0, 7.0];

/// Largest error of measured points about the calibrated principal point with the calibrated
/// camera, nm: they are not rounded, and only the μ₂ terms are left out.
const LARGEST_MEASURED_NM: f64 = 1.0;

/// Exposures from rest, far from the calibrated place and out of focus.
const EXPOSURES: [(f64, f64, f64, f64); 4] = [
    (0.17, 0.01, 0.145, 10.0),
    (0.17, 0.005, -0.2, -10.0),
    (0.05, 0.02, 0.0, 5.0),
    (0.1, 0.005, 0.1, 0.0),
];

#[test]
fn one_camera_serves_all_frames_from_rest_on_all_axes_and_out_of_focus() {
    for (name, text) in CAMERA_FILES {
        for axis in ["+x", "-x", "+y", "-y"] {
            let text = format!(
                "{text}\n[fmc]\naxis = \"{axis}\"\nstrategy = \"from-rest\"\nflatness_um = [3.0, 5.0]\n"
            );
            check(name, &text);
        }
    }
}

fn check(name: &str, text: &str) {
    let (camera, _) = CameraFile::parse(name, text).unwrap();
    let bench = Bench::with(text, b"");
    let points: Vec<[f32; 2]> = grid::points(camera.half_format_mm())
        .points()
        // Rounding to single precision may put the edge beyond the edge.
        .map(|point| [point.x_mm, point.y_mm].map(|one| one * 0.9999))
        .collect();
    let mut table = String::from("sequence,vh,exposure,opening_offset_mm,focus_shift_um\n");
    let mut rows = String::from("sequence,x_mm,y_mm\n");
    for (frame, (vh, exposure, offset, focus)) in EXPOSURES.iter().enumerate() {
        writeln!(table, "{frame},{vh},{exposure},{offset},{focus}").unwrap();
        for [x, y] in points.iter().map(|point| point.map(f64::from)) {
            writeln!(rows, "{frame},{x},{y}").unwrap();
        }
    }
    fs::write(bench.path("frames.csv"), table).unwrap();
    fs::write(bench.path("points.csv"), rows).unwrap();
    let answer = |answer: &str| -> Vec<[f64; 2]> {
        let arguments = [
            "correct",
            "--camera",
            "camera.toml",
            "--frames",
            "frames.csv",
        ];
        let more = ["--answer", answer, "points.csv"];
        let text = bench.run(&[&arguments[..], &more].concat()).ok().stdout;
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let rows = reader.records();
        rows.map(|row| [1, 2].map(|cell| row.as_ref().unwrap()[cell].parse().unwrap()))
            .collect()
    };
    let [ideal, measured] = ["ideal-shifted", "measured-shifted"].map(answer);
    let lens = Lens::of(&camera);
    let [x0, y0] = camera.principal_point_mm;
    let axis = camera.fmc.axis.unit();
    let (mut ideal_nm, mut measured_nm, mut left_nm) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (frame, (vh, exposure, offset, focus)) in EXPOSURES.iter().enumerate() {
        let request = ExposureRequest {
            opening_offset_mm: Some(*offset),
            focus_shift_mm: focus / 1000.0,
            focus_formula: FocusFormula::Physical,
            ..ExposureRequest::planned(*vh, *exposure)
        };
        let solver = StrictSolver::new(&camera, &request, Weight::Exposure);
        let centroid_mm = solver.path().centroid_mm();
        for (index, [x, y]) in points.iter().enumerate() {
            let point = [*x, *y].map(f64::from);
            let strict = solver.total(point, Reading::Consistent).distortion_mm;
            let expected: [f64; 2] =
                std::array::from_fn(|i| point[i] - strict[i] - centroid_mm * axis[i]);
            let row = frame * points.len() + index;
            // The calibrated camera on the measured point.
            let [mx, my] = measured[row];
            let [dx, dy] = lens.displacement([mx - x0, my - y0]);
            let corrected = [mx - dx, my - dy];
            for i in 0..2 {
                ideal_nm = ideal_nm.max(1e6 * (ideal[row][i] - expected[i]).abs());
                measured_nm = measured_nm.max(1e6 * (corrected[i] - expected[i]).abs());
                left_nm = left_nm.max(1e6 * (centroid_mm * axis[i]).abs());
            }
        }
    }
    let [small, large] = LARGEST_NM;
    let [half_width, _] = camera.half_format_mm();
    let allowed_nm = if half_width < 40.0 { small } else { large };
    assert!(ideal_nm <= allowed_nm, "{name}: {ideal_nm} nm");
    assert!(
        measured_nm <= LARGEST_MEASURED_NM,
        "{name}: {measured_nm} nm"
    );
    assert!(
        left_nm > 1e5,
        "{name}: the frames are far from the calibrated place"
    );
}
