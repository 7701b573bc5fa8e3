//! `budget`: the terms of a camera's error budget.

use std::fs;

use crate::command_line::support::{Bench, CAMERA};

const BUDGET: [&str; 3] = ["budget", "--camera", "camera.toml"];

/// Returns the summary of a budget with more arguments.
fn summary(bench: &Bench, more: &[&str]) -> serde_json::Value {
    let arguments = [&BUDGET[..], &["--out", "out"], more].concat();
    bench.run(&arguments).ok();
    serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap()
}

fn effect(summary: &serde_json::Value, source: &str, key: &str) -> f64 {
    let terms = summary["terms"].as_array().unwrap();
    let term = terms.iter().find(|term| term["source"] == source);
    term.unwrap()[key].as_f64().unwrap()
}

#[test]
fn page_names_every_term_and_the_report_is_complete() {
    let bench = Bench::new();
    let answer = bench.run(&BUDGET).ok();
    for part in [
        "calibrated principal point",
        "time of opening",
        "static distortion",
        "focus shift",
        "encoder",
        "roll or pitch rate: 1°/s",
        "cm on the ground",
        "Take principal point and time",
    ] {
        assert!(answer.stdout.contains(part), "{part}: {}", answer.stdout);
    }
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
    let summary = summary(&bench, &[]);
    assert_eq!(summary["terms"].as_array().unwrap().len(), 14);
    for file in ["budget.png", "budget.svg", "report.html"] {
        assert!(fs::metadata(bench.path("out").join(file)).unwrap().len() > 1000);
    }
    // 17 mm/s for 20 ms is 340 µm; ramps of 20 and 10 % move the centroid off the middle.
    let opening_um = effect(&summary, "opening-time", "limits_um");
    assert!((opening_um - 340.0 * (0.5 + 0.1 * 2.4 / (6.0 * 1.7))).abs() < 1e-6);
    // H/f = 10000 at 1000 m, so an error in cm on the ground is the same number as in µm on the
    // sensor.
    let ground_cm = effect(&summary, "opening-time", "limits_ground_cm");
    assert!((ground_cm - opening_um).abs() < 1e-9);
    assert!(effect(&summary, "calibrated-principal-point", "limits_um") < 1e-9);
}

#[test]
fn assumptions_are_taken_and_scale_their_terms() {
    let bench = Bench::new();
    let before = summary(&bench, &[]);
    for (option, value, source, factor) in [
        ("--vh-error-percent", "2", "vh-error", 2.0),
        ("--encoder-um", "0.5", "encoder", 0.5),
        ("--timing-ms", "1", "timing", 10.0),
        ("--rate-deg-s", "3", "yaw-rate", 3.0),
        ("--drift-deg", "0", "drift", 0.0),
        ("--relief-percent", "0", "relief", 0.0),
    ] {
        let after = summary(&bench, &[option, value]);
        let ratio = effect(&after, source, "limits_um") / effect(&before, source, "limits_um");
        // The smear is computed by the camera, in single precision.
        assert!((ratio - factor).abs() < 1e-6, "{option}: {ratio}");
    }
}

#[test]
fn camera_that_cannot_take_the_papers_exposures_is_told_its_own() {
    let other = CAMERA.replace("[0.05, 0.17]", "[0.2, 0.3]");
    let bench = Bench::with(&other, b"");
    let answer = bench.run(&BUDGET).ok();
    assert!(answer.stdout.contains("which this camera cannot take"));
    let summary = summary(&bench, &[]);
    assert!(summary["terms"][0]["paper_um"].is_null());
    assert!(summary["terms"][0]["limits_um"].is_number());
}

#[test]
fn bad_input_is_refused_with_value_and_range() {
    let bench = Bench::new();
    for (option, value, range) in [
        ("--height-m", "0", "10 to 20000"),
        ("--height-m", "nan", "10 to 20000"),
        ("--focus-um", "-1", "0 to 100"),
        ("--vh-error-percent", "51", "0 to 50"),
        ("--relief-percent", "100", "0 to 50"),
        ("--drift-deg", "x", "0 to 45"),
        ("--rate-deg-s", "-1", "0 to 60"),
        ("--encoder-um", "inf", "0 to 100"),
        ("--timing-ms", "-0.1", "0 to 100"),
    ] {
        bench
            .run(&[&BUDGET[..], &[option, value]].concat())
            .refused(&[option, value, range]);
    }
    bench.run(&["budget"]).refused(&["--camera"]);
    let short = CAMERA.replace("stroke_mm = 4.0", "stroke_mm = 0.01");
    Bench::with(&short, b"")
        .run(&BUDGET)
        .refused(&["camera.toml", "stroke"]);
}
