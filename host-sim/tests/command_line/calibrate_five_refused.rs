//! `calibrate five` on observations that do not determine a calibration.

use std::fmt::Write as _;
use std::fs;

use crate::command_line::observations::{EXPOSURES, Row, csv, noisy, rows};
use crate::command_line::support::Bench;

/// Checks for exit code 2, a message with every one of `words`, and no output.
fn refused(observations: &str, words: &[&str]) {
    refused_with(observations, &[], words);
}

fn refused_with(observations: &str, more: &[&str], words: &[&str]) {
    let bench = Bench::new();
    fs::write(bench.path("obs.csv"), observations).unwrap();
    let arguments = [
        "calibrate",
        "five",
        "obs.csv",
        "--camera",
        "camera.toml",
        "--out",
        "out",
    ];
    let answer = bench.run(&[&arguments, more].concat());
    answer.refused(words);
    answer.refused(&["obs.csv"]);
    assert_eq!(bench.files(), ["camera.toml", "obs.csv", "points.csv"]);
}

fn good() -> Vec<Row> {
    noisy(rows(&EXPOSURES, 9), 0.85, 1)
}

#[test]
fn fewer_than_three_points_are_too_few() {
    refused(&csv(&good()[..2]), &["line 3", "2 points", "at least 3"]);
    refused(&csv(&[]), &["0 points", "at least 3"]);
}

#[test]
fn points_on_a_line_are_named() {
    let diagonal: Vec<Row> = good()
        .into_iter()
        .filter(|row| (row.x_mm - row.y_mm).abs() < 1e-9)
        .collect();
    let words = [
        "lines 2 to",
        "on one line",
        "x_mm -40 to 40",
        "at least 0.057 mm",
    ];
    refused(&csv(&diagonal), &words);
    let column: Vec<Row> = good()
        .into_iter()
        .filter(|row| (row.x_mm - 10.0).abs() < 1e-9)
        .collect();
    refused(&csv(&column), &["on one line", "x_mm 10 to 10"]);
}

#[test]
fn one_exposure_cannot_be_told_from_a_static_decentring() {
    let one = csv(&noisy(rows(&EXPOSURES[5..], 21), 0.85, 1));
    let words = [
        "K_d1 and P_m1 cannot be separated from the static decentring",
        "P2",
        "vh_per_s 0.17 to 0.17",
        "exposure_s 0.01 to 0.01",
        "--static-p2 known",
    ];
    refused(&one, &words);
    refused_with(&one, &["--static-p2", "estimate"], &words);
    refused_with(&one, &["--regress-on", "centroid"], &words);
    refused_with(
        &one,
        &["--tie"],
        &["P_m1 and the static decentring", "cannot be separated"],
    );
}

#[test]
fn id_that_appears_twice_is_named_with_both_lines() {
    let text = csv(&good()).replace("\np40,", "\np7,");
    refused(&text, &["lines 9 and 42", "id p7", "twice"]);
}

#[test]
fn sigma_of_zero_is_named() {
    let with_sigma = |sigma: &str| {
        let mut text = String::new();
        for (index, line) in csv(&good()).lines().enumerate() {
            let sigma = match index {
                0 => "sigma_um",
                5 => sigma,
                _ => "0.85",
            };
            writeln!(text, "{line},{sigma}").unwrap();
        }
        text
    };
    let words = ["line 6", "sigma_um = 0 is outside 0.0001 to 10000"];
    refused(&with_sigma("0"), &words);
    refused(&with_sigma("-1"), &["line 6", "sigma_um = -1"]);
    refused(&with_sigma("nan"), &["line 6", "sigma_um", "nan"]);
    refused(&with_sigma(""), &["line 6", "sigma_um"]);
}

fn scaled(change: fn(&mut Row)) -> String {
    let mut rows = good();
    rows.iter_mut().for_each(change);
    csv(&rows)
}

#[test]
fn coordinates_in_other_units_are_named() {
    refused(
        &scaled(|row| row.x_mm *= 1000.0),
        &[
            "line 2",
            "x_mm = -40000",
            "factor of 992",
            "-40.32 to 40.32",
            "µm",
        ],
    );
    refused(
        &scaled(|row| {
            row.x_mm /= 1000.0;
            row.y_mm /= 1000.0;
        }),
        &["x_mm = ", "-40.32 to 40.32", "is it in m"],
    );
    refused(
        &scaled(|row| row.y_mm *= 1.02),
        &["y_mm = -40.8", "factor of 1.012", "-40.32 to 40.32"],
    );
}

#[test]
fn distortions_in_other_units_are_named() {
    refused(
        &scaled(|row| row.dx_um *= 1000.0),
        &["dx_um", "nm", "line "],
    );
    refused(
        &scaled(|row| {
            row.dx_um /= 1000.0;
            row.dy_um /= 1000.0;
        }),
        &["dx_um", "is it in mm", "static calibration", "line "],
    );
    refused(
        &scaled(|row| row.dy_um /= 1000.0),
        &["dy_um", "is it in mm"],
    );
    let mut one = good();
    one[3].dx_um = 2e5;
    refused(&csv(&one), &["line 5", "dx_um = 200000", "100000"]);
}

#[test]
fn exposures_that_the_camera_cannot_make_are_named() {
    let change = |change: fn(&mut Row)| {
        let mut rows = good();
        change(&mut rows[7]);
        csv(&rows)
    };
    refused(
        &change(|row| row.vh = 50.0),
        &["line 9", "vh_per_s = 50 is outside 0.05 to 0.17"],
    );
    refused(
        &change(|row| row.exposure_s = 10.0),
        &["line 9", "exposure_s = 10 is outside 0.001 to 0.02"],
    );
    refused(
        &change(|row| row.offset_mm = 3.0),
        &["line 9", "opening_offset_mm = 3", "stroke"],
    );
    refused(
        &change(|row| row.offset_mm = 145.0),
        &["line 9", "opening_offset_mm = 145"],
    );
}

#[test]
fn header_and_row_faults_are_named() {
    refused("", &["empty"]);
    refused("x_mm,y_mm\n1,2\n", &["line 1", "dx_um is missing"]);
    let text = csv(&good());
    refused(
        &text.replacen("dy_um", "dx_um", 1),
        &["dx_um appears twice"],
    );
    refused(
        &text.replacen("\np3,", "\np3,left,", 1),
        &["line 5", "9 columns", "8"],
    );
    let (head, rest) = text.split_at(text.find("\np3,").unwrap());
    let cut = rest.replacen(",0.05,", ",fast,", 1);
    refused(&format!("{head}{cut}"), &["line 5", "vh_per_s", "fast"]);
}

#[test]
fn output_never_replaces_the_camera_file() {
    let bench = Bench::new();
    fs::write(bench.path("obs.csv"), csv(&good())).unwrap();
    let before = fs::read(bench.path("camera.toml")).unwrap();
    let answer = bench.run(&[
        "calibrate",
        "five",
        "obs.csv",
        "--camera",
        "camera.toml",
        "--out",
        ".",
    ]);
    answer.refused(&["camera.toml", "camera file itself"]);
    assert_eq!(fs::read(bench.path("camera.toml")).unwrap(), before);
    assert_eq!(bench.files(), ["camera.toml", "obs.csv", "points.csv"]);
}

/// The lens has never been calibrated, so its distortions cannot be compared with any.
#[test]
fn millimetres_of_a_lens_that_is_not_known_yet_are_named() {
    let rows: Vec<Row> = good()
        .into_iter()
        .map(|row| Row {
            dx_um: 1e-3 * row.dx_um,
            dy_um: 1e-3 * row.dy_um,
            ..row
        })
        .collect();
    let bench = Bench::with(
        "name = \"new\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n",
        b"",
    );
    fs::write(bench.path("obs.csv"), csv(&rows)).unwrap();
    bench
        .run(&["calibrate", "five", "obs.csv", "--camera", "camera.toml"])
        .refused(&["obs.csv", "dx_um and dy_um", "in mm?"]);
}

#[test]
fn sigma_that_is_not_that_of_the_residuals_is_named() {
    for sigma_um in ["0.00085", "850"] {
        let text = csv(&good());
        let mut lines = text.lines();
        let mut with_sigma = format!("{},sigma_um\n", lines.next().unwrap());
        for line in lines {
            let _ = writeln!(with_sigma, "{line},{sigma_um}");
        }
        refused(&with_sigma, &["times sigma_um", "outside 0.02 to 50"]);
    }
}

#[test]
fn corrections_instead_of_distortions_are_named() {
    let rows: Vec<Row> = good()
        .into_iter()
        .map(|row| Row {
            dx_um: -row.dx_um,
            dy_um: -row.dy_um,
            ..row
        })
        .collect();
    refused(
        &csv(&rows),
        &["against the static calibration", "corrections?"],
    );
}

#[test]
fn observation_that_stands_twice_is_named_by_both_lines() {
    let text = csv(&good());
    let second = text.lines().nth(1).unwrap();
    let again = second.split_once(',').unwrap().1;
    refused(
        &format!("{text}again,{again}\n"),
        &["lines 2 and", "the same observation twice"],
    );
}

#[test]
fn observations_are_not_replaced_by_the_residuals() {
    let bench = Bench::new();
    fs::create_dir(bench.path("out")).unwrap();
    let text = csv(&good());
    fs::write(bench.path("out/residuals.csv"), &text).unwrap();
    bench
        .run(&[
            "calibrate",
            "five",
            "out/residuals.csv",
            "--camera",
            "camera.toml",
            "--out",
            "out",
        ])
        .refused(&["out/residuals.csv", "name another folder"]);
    assert_eq!(
        fs::read_to_string(bench.path("out/residuals.csv")).unwrap(),
        text
    );
}
