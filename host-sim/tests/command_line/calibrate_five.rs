//! `calibrate five` on good observations.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use crate::command_line::calibration_files::assert_certified;
use crate::command_line::observations::{
    EXPOSURES, Noise, Row, TRUTH, csv, distortion_um, noisy, rows,
};
use crate::command_line::support::{Answer, Bench, CAMERA};

const KEYS: [&str; 5] = ["km0", "km1", "km2", "kd1", "pm1"];

fn calibrate(observations: &str, more: &[&str]) -> (Bench, Answer) {
    let bench = Bench::new();
    fs::write(bench.path("obs.csv"), observations).unwrap();
    let mut arguments = vec!["calibrate", "five", "obs.csv", "--camera", "camera.toml"];
    arguments.extend(more);
    let answer = bench.run(&arguments);
    (bench, answer)
}

fn summary(observations: &str, more: &[&str]) -> Value {
    let (bench, answer) = calibrate(observations, &[&["--out", "out"], more].concat());
    answer.ok();
    serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap()
}

fn number(summary: &Value, key: &str, what: &str) -> f64 {
    summary["coefficients"][key][what].as_f64().unwrap()
}

#[test]
fn noise_free_observations_give_their_coefficients_back() {
    let summary = summary(&csv(&rows(&EXPOSURES, 9)), &[]);
    for (key, truth) in KEYS.into_iter().zip(TRUTH) {
        let value = number(&summary, key, "value");
        assert!((value / truth - 1.0).abs() < 1e-9, "{key} = {value}");
    }
    assert_eq!(summary["rejected"].as_array().unwrap().len(), 0);
    assert_eq!(summary["redundancy"], 2 * 486 - 5);
    assert_eq!(summary["exposures"], 6);
}

#[test]
fn folder_receives_camera_residuals_summary_and_figures() {
    let observations = csv(&noisy(rows(&EXPOSURES, 9), 0.85, 1));
    let (bench, answer) = calibrate(&observations, &["--out", "out"]);
    let answer = answer.ok();
    for word in [
        "km0",
        "pm1",
        "correlations",
        "σ0",
        "rms",
        "as printed",
        "0 rejected",
    ] {
        assert!(answer.stdout.contains(word), "{word}:\n{}", answer.stdout);
    }
    let mut files: Vec<_> = fs::read_dir(bench.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(
        files,
        [
            "camera.toml",
            "residual-vectors.svg",
            "residuals-exposure.svg",
            "residuals-field-angle.svg",
            "residuals-order.svg",
            "residuals-vh.svg",
            "residuals.csv",
            "summary.json",
        ]
    );
    assert_certified(&bench, "out");
    for figure in files.iter().filter(|name| name.contains(".svg")) {
        let svg = fs::read_to_string(bench.path("out").join(figure)).unwrap();
        assert!(svg.ends_with("</svg>\n") && svg.len() > 5000, "{figure}");
        assert!(!svg.contains("NaN"), "{figure}");
    }
    let residuals = fs::read_to_string(bench.path("out/residuals.csv")).unwrap();
    assert_eq!(residuals.lines().count(), 487);

    let summary: Value =
        serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap();
    let sigma0 = summary["sigma0"].as_f64().unwrap();
    assert!((sigma0 - 0.85).abs() < 0.06, "{sigma0}");
    for (key, truth) in KEYS.into_iter().zip(TRUTH) {
        let error = number(&summary, key, "value") - truth;
        let deviation = number(&summary, key, "standard_deviation");
        assert!(
            error.abs() < 3.5 * deviation,
            "{key}: {error} ± {deviation}"
        );
    }

    // Everything but [fitted] is unchanged, and the fitted model runs.
    let camera = fs::read_to_string(bench.path("out/camera.toml")).unwrap();
    let (before, _) = CAMERA.split_once("[fitted]").unwrap();
    assert!(camera.starts_with(before), "{camera}");
    let correct = |camera: &str| {
        let arguments = [
            "correct",
            "--camera",
            camera,
            "--vh",
            "0.1",
            "--exposure",
            "0.01",
            "--model",
            "fitted",
            "--opening-offset-mm",
            "0",
            "points.csv",
        ];
        bench.run(&arguments).ok().rows()
    };
    for (_, [_, _, dx_um, dy_um]) in correct("out/camera.toml").into_iter().take(1) {
        let [x, y] = distortion_um(TRUTH, 10.0, -20.0, 0.1);
        assert!((dx_um - x).abs() < 0.3 && (dy_um - y).abs() < 0.3);
    }
}

#[test]
fn gross_errors_in_a_fifth_of_the_points_do_not_move_the_result_beyond_its_sigma() {
    let good = noisy(rows(&EXPOSURES, 9), 0.85, 2);
    let clean = summary(&csv(&good), &[]);
    // The gross errors are scattered, then all in one direction.
    for one_sided in [false, true] {
        let mut noise = Noise(3);
        let mut bad = good.clone();
        let mut spoilt = Vec::new();
        for (index, row) in bad.iter_mut().enumerate() {
            if index % 5 == 2 {
                let size = if one_sided {
                    40.0
                } else {
                    20.0 + 400.0 * noise.uniform()
                };
                let turn = std::f64::consts::TAU * noise.uniform();
                let [x, y] = if one_sided {
                    [0.6, 0.8]
                } else {
                    [turn.cos(), turn.sin()]
                };
                row.dx_um += size * x;
                row.dy_um += size * y;
                spoilt.push(u64::try_from(index).unwrap() + 2);
            }
        }
        let robust = summary(&csv(&bad), &[]);
        let rejected: Vec<u64> = robust["rejected"]
            .as_array()
            .unwrap()
            .iter()
            .map(|row| row["line"].as_u64().unwrap())
            .collect();
        assert_eq!(rejected, spoilt, "one-sided: {one_sided}");
        for key in KEYS {
            let moved = number(&robust, key, "value") - number(&clean, key, "value");
            let deviation = number(&robust, key, "standard_deviation");
            assert!(moved.abs() < deviation, "{key}: {moved} of {deviation}");
        }
    }
}

#[test]
fn observation_a_thousand_sigma_off_is_named_and_harms_nothing() {
    let good = noisy(rows(&EXPOSURES, 9), 0.85, 4);
    let clean = summary(&csv(&good), &[]);
    let mut bad = good;
    bad[100].dy_um += 850.0;
    let (bench, answer) = calibrate(&csv(&bad), &["--out", "out"]);
    let answer = answer.ok();
    let line = answer
        .stdout
        .lines()
        .find(|line| line.starts_with("rejected"))
        .unwrap();
    assert!(line.contains("line 102 (p100)"), "{line}");
    assert!(line.contains("test value 1"), "{line}");
    let summary: Value =
        serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["rejected"].as_array().unwrap().len(), 1);
    for key in KEYS {
        let moved = number(&summary, key, "value") - number(&clean, key, "value");
        let deviation = number(&summary, key, "standard_deviation");
        assert!(moved.abs() < 0.1 * deviation, "{key}");
    }
}

#[test]
fn sigma_column_weighs_and_makes_sigma0_a_factor() {
    let mut text = String::new();
    let rows = noisy(rows(&EXPOSURES, 9), 0.85, 5);
    for (index, line) in csv(&rows).lines().enumerate() {
        let sigma = if index == 0 { "sigma_um" } else { "0.85" };
        writeln!(text, "{line},{sigma}").unwrap();
    }
    let weighted = summary(&text, &[]);
    let sigma0 = weighted["sigma0"].as_f64().unwrap();
    assert!((sigma0 - 1.0).abs() < 0.07, "{sigma0}");
    let unweighted = summary(&csv(&rows), &[]);
    for key in KEYS {
        let of = |what| number(&weighted, key, what) / number(&unweighted, key, what);
        assert!((of("value") - 1.0).abs() < 1e-9);
        assert!((of("standard_deviation") - 1.0).abs() < 1e-9);
    }
}

#[test]
fn options_reach_the_fit() {
    let exact = rows(&EXPOSURES, 9);
    let tied = summary(&csv(&exact), &["--tie"]);
    let ratio = number(&tied, "kd1", "value") / number(&tied, "pm1", "value");
    assert!((ratio - 2.0).abs() < 1e-12);
    assert_eq!(tied["unknowns"], 4);

    let (bench, answer) = calibrate(
        &csv(&exact),
        &[
            "--static-p2",
            "estimate",
            "--regress-on",
            "centroid",
            "--out",
            "out",
        ],
    );
    answer.ok();
    let summary: Value =
        serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap();
    assert!((number(&summary, "p2", "value") / -2e-6 - 1.0).abs() < 1e-7);
    // c̄ is the same part of δ in all exposures: E[τ]/t of ramps 0.2 and 0.1.
    let centroid = 0.5 + 0.1 * (3.0 - 0.6) / (6.0 * 1.7);
    let kd1 = number(&summary, "kd1", "value");
    assert!((kd1 * centroid / TRUTH[3] - 1.0).abs() < 1e-8);
    let camera = fs::read_to_string(bench.path("out/camera.toml")).unwrap();
    assert!(camera.contains("per = \"centroid\""), "{camera}");
    // Applied to c̄, the coefficients give the same distortion.
    let answer = bench
        .run(&[
            "reference",
            "--camera",
            "out/camera.toml",
            "--vh",
            "0.17",
            "--exposure",
            "0.01",
            "--model",
            "fitted",
            "--opening-offset-mm",
            "0",
            "points.csv",
        ])
        .ok();
    let [_, _, dx_um, dy_um] = answer.rows()[0].1;
    let [x, y] = distortion_um(TRUTH, 10.0, -20.0, 0.17);
    assert!((dx_um - x).abs() < 1e-5 && (dy_um - y).abs() < 1e-5);
}

#[test]
fn one_exposure_suffices_where_the_decentring_is_believed() {
    let one = csv(&rows(&EXPOSURES[5..], 9));
    let summary = summary(&one, &["--static-p2", "known"]);
    for (key, truth) in KEYS.into_iter().zip(TRUTH) {
        assert!((number(&summary, key, "value") / truth - 1.0).abs() < 1e-8);
    }
}

#[test]
fn centred_exposures_are_said_to_have_no_dynamic_terms() {
    let mut centred = rows(&EXPOSURES, 9);
    let centroid = 0.5 + 0.1 * (3.0 - 0.6) / (6.0 * 1.7);
    for row in &mut centred {
        let [km0, km1, km2, _, _] = TRUTH;
        let [dx_um, dy_um] = distortion_um([km0, km1, km2, 0.0, 0.0], row.x_mm, row.y_mm, 0.0);
        *row = Row {
            dx_um,
            dy_um,
            offset_mm: -100.0 * row.vh * row.exposure_s * centroid,
            ..row.clone()
        };
    }
    let (_, answer) = calibrate(&csv(&noisy(centred.clone(), 0.85, 6)), &[]);
    let stdout = answer.ok().stdout;
    let words: Vec<&str> = stdout.split_whitespace().collect();
    assert!(words.join(" ").contains("they do not exist"), "{stdout}");
    let (_, answer) = calibrate(&csv(&centred), &["--regress-on", "centroid"]);
    answer.refused(&["obs.csv", "K_d1 and P_m1 do not exist", "centred"]);
}

#[test]
fn columns_may_stand_in_any_order_and_byte_order_mark_and_crlf_are_accepted() {
    let rows = rows(&EXPOSURES, 5);
    let mut text = String::from(
        "\u{feff}opening_offset_mm,note,dy_um,dx_um,exposure_s,y_mm,vh_per_s,x_mm\r\n",
    );
    for row in &rows {
        write!(
            text,
            "{},-,{},{},{},{},{},{}\r\n",
            row.offset_mm, row.dy_um, row.dx_um, row.exposure_s, row.y_mm, row.vh, row.x_mm
        )
        .unwrap();
    }
    let summary = summary(text.trim_end(), &[]);
    for (key, truth) in KEYS.into_iter().zip(TRUTH) {
        assert!((number(&summary, key, "value") / truth - 1.0).abs() < 1e-9);
    }
}

#[test]
fn coefficients_that_fold_the_image_have_reports_but_no_camera_file() {
    let folding = [1.5e-4, -1.1e-6, 2.2e-10, 3e-3, 1.4e-6];
    let mut observations = rows(&EXPOSURES, 9);
    for row in &mut observations {
        let s = 100.0 * row.vh * row.exposure_s;
        [row.dx_um, row.dy_um] = distortion_um(folding, row.x_mm, row.y_mm, s);
    }
    let (bench, answer) = calibrate(&csv(&observations), &["--out", "out"]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    let plain = answer.stderr.split_whitespace().collect::<Vec<_>>();
    let plain = plain.join(" ");
    for words in [
        "no camera file is written, the reports are",
        "[fitted]",
        "at least",
    ] {
        assert!(plain.contains(words), "{words} not in: {plain}");
    }
    assert!(bench.path("out/summary.json").exists());
    assert!(!bench.path("out/camera.toml").exists());
    let (_, answer) = calibrate(&csv(&observations), &[]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
}
