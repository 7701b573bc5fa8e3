//! Observations of calibrations, and the checks that all methods share.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use crate::command_line::support::{Answer, Bench};

/// K1 of the simulated lens, mm⁻².
pub(crate) const K1: f64 = -1e-6;
/// Principal distance and principal point of the simulated lens, mm.
pub(crate) const INTERIOR: [f64; 3] = [100.5, 0.03, -0.05];

/// Returns the measured point of an object point seen from (0, 0, `height_m`) straight down, mm.
pub(crate) fn seen(object: [f64; 3], height_m: f64) -> [f64; 2] {
    let [f_mm, x0, y0] = INTERIOR;
    let scale = f_mm / (height_m - object[2]);
    let ideal = [scale * object[0], scale * object[1]];
    let mut point = ideal;
    for _ in 0..100 {
        let factor = K1 * (point[0] * point[0] + point[1] * point[1]);
        point = [0, 1].map(|axis| ideal[axis] + point[axis] * factor);
    }
    [point[0] + x0, point[1] + y0]
}

/// A spatial test field of 60 points, with a repeatable deviation of the size of a noise, µm.
pub(crate) fn field_csv(noise_um: f64) -> String {
    let mut text = String::from("point,x_mm,y_mm,x_m,y_m,z_m,sigma_um\n");
    for index in 0..60_u32 {
        let [column, row, layer] = [index % 5, index / 5 % 4, index / 20].map(f64::from);
        let object = [
            1.1 * column - 2.2,
            1.3 * row - 1.95 + 0.05 * layer,
            0.9 * layer - 0.9 + 0.1 * column,
        ];
        let measured = seen(object, 7.0);
        let wave = |phase: f64| 1e-3 * noise_um * (7.7 * f64::from(index) + phase).sin();
        let _ = writeln!(
            text,
            "{index},{:.12},{:.12},{:.12},{:.12},{:.12},1",
            measured[0] + wave(0.0),
            measured[1] + wave(2.1),
            object[0],
            object[1],
            object[2]
        );
    }
    text
}

/// A plane target of 15 x 15 at two focus settings, or at one.
pub(crate) fn plane_csv(focus: &[&str]) -> String {
    let column = if focus.is_empty() { "" } else { ",focus" };
    let mut text = format!("target,x_mm,y_mm,x_m,y_m{column}\n");
    let settings: Vec<String> = if focus.is_empty() {
        vec![String::new()]
    } else {
        focus.iter().map(|name| format!(",{name}")).collect()
    };
    for (setting, label) in settings.iter().enumerate() {
        for index in 0..225_u32 {
            let [column, row] = [index % 15, index / 15].map(f64::from);
            let plane = [0.38 * (column - 7.0), 0.38 * (row - 7.0)];
            let height = if setting == 0 { 7.0 } else { 7.5 };
            let [x, y] = seen([plane[0], plane[1], 0.0], height);
            let _ = writeln!(
                text,
                "{index},{x:.12},{y:.12},{:.12},{:.12}{label}",
                plane[0], plane[1]
            );
        }
    }
    text
}

/// Angles of a turntable over ±18° for the same lens, two bands, two repetitions.
pub(crate) fn angles_csv() -> String {
    let mut text = String::from("angle_deg,l_mm,band,repeat\n");
    for band in ["B1", "B2"] {
        for repeat in 1..=2_u32 {
            for index in 0..29_u32 {
                let angle = 18.0 * (f64::from(index) / 14.0 - 1.0);
                let [x, _] = seen([7.0 * angle.to_radians().tan(), 0.0, 0.0], 7.0);
                // Zero of the angles at the principal point; a deviation of 0.2 µm.
                let wave = 2e-4 * (f64::from(index * repeat) * 2.3).sin();
                let _ = writeln!(text, "{angle:.9},{:.12},{band},{repeat}", x + wave);
            }
        }
    }
    text
}

/// Run-out of the stage: z1, z2.
pub(crate) const RUN_OUT: [f64; 2] = [2e-3, -1.5e-3];

/// Directions of 9 x 9 for the same lens, at these offsets of a stage along +y.
pub(crate) fn field_angles_csv(offsets: &[f64]) -> String {
    let mut text = String::from("azimuth_deg,elevation_deg,x_mm,y_mm,stage_offset_mm\n");
    let [_, x0, y0] = INTERIOR;
    let [z1, z2] = RUN_OUT;
    for (round, c) in (0_u32..).zip(offsets) {
        for index in 0..81_u32 {
            let [column, row] = [index % 9, index / 9].map(|place| f64::from(place) - 4.0);
            let [azimuth, elevation] = [5.25 * column, 4.75 * row];
            let [a, e] = [azimuth, elevation].map(f64::to_radians);
            let [x, y] = seen([7.0 * a.tan(), 7.0 * e.tan() / a.cos(), 0.0], 7.0);
            let larger = 1.0 + (z1 * c + z2 * c * c) / 110.0;
            // A deviation of 0.5 µm.
            let wave = |phase: f64| 5e-4 * (7.7 * f64::from(index + 81 * round) + phase).sin();
            let _ = writeln!(
                text,
                "{azimuth},{elevation},{:.12},{:.12},{c}",
                x0 + larger * (x - x0) + wave(0.0),
                y0 + larger * (y - y0) + c + wave(2.1),
            );
        }
    }
    text
}

/// Runs a method on a file of observations, with `--out out`.
pub(crate) fn calibrated(method: &str, observations: &str, more: &[&str]) -> (Bench, Answer) {
    let bench = Bench::new();
    fs::write(bench.path("obs.csv"), observations).unwrap();
    let arguments = [
        "calibrate",
        method,
        "obs.csv",
        "--camera",
        "camera.toml",
        "--out",
        "out",
    ];
    let answer = bench.run(&[&arguments, more].concat());
    (bench, answer)
}

/// Reads a summary.
pub(crate) fn summary(bench: &Bench, path: &str) -> Value {
    serde_json::from_slice(&fs::read(bench.path(path)).unwrap()).unwrap()
}

/// Returns value and σ of a parameter.
pub(crate) fn parameter(summary: &Value, name: &str) -> (f64, f64) {
    let list = summary["parameters"].as_array().unwrap();
    let found = list.iter().find(|one| one["name"] == name).unwrap();
    (
        found["value"].as_f64().unwrap(),
        found["sigma"].as_f64().unwrap(),
    )
}

/// Checks the reports, and that the certificate takes the folder's camera file and summary.
pub(crate) fn assert_complete(bench: &Bench, answer: &Answer, folder: &str) {
    assert_reports(bench, answer, folder);
    assert_certified(bench, folder);
}

/// Checks keys of the summary that other programs rely on, lines of at most 80 columns, and a page
/// that stands alone.
pub(crate) fn assert_reports(bench: &Bench, answer: &Answer, folder: &str) {
    for line in answer.stdout.lines() {
        let is_one_line = line.starts_with("rejected");
        assert!(is_one_line || line.chars().count() <= 80, "{line}");
    }
    let summary = summary(bench, &format!("{folder}/summary.json"));
    for key in [
        "method",
        "camera",
        "datum",
        "observations",
        "unknowns",
        "redundancy",
        "sigma0",
        "residual_rms_um",
        "residual_max_um",
        "rejected",
        "iterations",
        "warnings",
        "observed",
        "parameters",
        "correlations",
        "groups",
        "inputs",
        "profile",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
    let page = fs::read_to_string(bench.path(&format!("{folder}/certificate.html"))).unwrap();
    let links = page.match_indices("http");
    let links = links.filter(|(at, _)| !page[*at..].starts_with("http://www.w3.org/2000/svg"));
    assert_eq!(links.count(), 0);
    assert!(!page.contains("NaN"));
    assert!(page.contains("function of the <em>measured</em> point"));
    for name in [
        "residuals.csv",
        "covariance.csv",
        "profile.svg",
        "coverage.svg",
    ] {
        assert!(bench.path(&format!("{folder}/{name}")).exists(), "{name}");
    }
}

/// Checks that the certificate takes the folder's camera file and summary, and states of the
/// calibration what the summary does: observations, redundancy, σ0, residuals, gross errors, every
/// σ, the correlations, and the part of the sensor with points.
pub(crate) fn assert_certified(bench: &Bench, folder: &str) {
    let camera = format!("{folder}/camera.toml");
    let calibration = format!("{folder}/summary.json");
    let arguments = ["--calibration", &calibration, "--out", "certificate"];
    bench
        .run(&[&["certificate", "--camera", &camera], &arguments[..]].concat())
        .ok();
    let summary = summary(bench, &calibration);
    let certificate = self::summary(bench, "certificate/certificate.json");
    let parameters = &certificate["parameters"];
    let line = &parameters["calibrations"][0];
    for key in ["method", "unknowns"] {
        assert_eq!(line[key], summary[key], "{key}");
    }
    // That of `five` has the name of a file, and the number of points.
    let observations = summary["observations"].as_u64();
    let observations = observations.or_else(|| Some(2 * summary["accepted"].as_u64()?));
    assert_eq!(line["observations"].as_u64(), observations);
    assert_eq!(
        line["rejected"].as_u64().unwrap(),
        summary["rejected"].as_array().unwrap().len() as u64
    );
    // Rounded to four digits.
    let same = |stated: &Value, known: f64, what: &str| {
        let stated = stated
            .as_f64()
            .unwrap_or_else(|| panic!("{what} is not stated"));
        assert!(
            (stated - known).abs() <= 1e-3 * known.abs(),
            "{what}: {stated} {known}"
        );
    };
    for key in ["redundancy", "sigma0"] {
        same(&line[key], summary[key].as_f64().unwrap(), key);
    }
    for key in ["rms_um", "largest_um"] {
        assert!(line[key].as_f64().unwrap() > 0.0, "{key}");
    }
    let stated = parameters["values"].as_array().unwrap();
    let estimated: Vec<(String, f64)> = match summary["parameters"].as_array() {
        Some(list) => list
            .iter()
            .map(|one| {
                (
                    one["name"].as_str().unwrap().to_owned(),
                    one["sigma"].as_f64().unwrap(),
                )
            })
            .collect(),
        None => summary["coefficients"]
            .as_object()
            .unwrap()
            .iter()
            .map(|(name, one)| (name.clone(), one["standard_deviation"].as_f64().unwrap()))
            .collect(),
    };
    let mut with_sigma = 0;
    for (name, sigma) in estimated.iter().filter(|(_, sigma)| *sigma > 0.0) {
        let found = stated.iter().find(|one| one["name"] == **name).unwrap();
        let digits = (found["sigma"].as_f64().unwrap() / sigma - 1.0).abs();
        assert!(digits < 6e-3, "{name}: {digits}");
        with_sigma += 1;
    }
    assert!(with_sigma > 3);
    let matrix = parameters["correlations"][0]["rows"].as_array().unwrap();
    assert_eq!(matrix.len(), with_sigma);
    for (place, row) in matrix.iter().enumerate() {
        let row = row.as_array().unwrap();
        assert_eq!(row.len(), with_sigma);
        assert!(row.iter().all(|one| one.as_f64().unwrap().abs() <= 1.0));
        assert_eq!(row[place], 1.0);
    }
    let observed = &parameters["observed"];
    let [stated, known] = [observed, &summary["observed"]].map(|one| one["radius_mm"].as_f64());
    assert!((stated.unwrap() - known.unwrap()).abs() <= 5e-3);
    assert!(observed["extrapolated_percent"].as_f64().unwrap() >= 0.0);
    let page = fs::read_to_string(bench.path("certificate/certificate.html")).unwrap();
    assert!(page.contains("Points were observed"));
}
