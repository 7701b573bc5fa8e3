//! Cost of one camera for all frames.

use std::fs;

use fmc_frames::row::NAMES;
use serde_json::Value;

use super::{IXM, export, json};
use crate::command_line::support::Bench;

/// Writes the records of one exposure, as `frame` computes it.
fn one_record(bench: &Bench, more: &[&str]) {
    let arguments = [
        "frame",
        "--camera",
        "camera.toml",
        "--vh",
        "0.17",
        "--exposure",
        "1/100",
        "--json",
    ];
    let answer = bench.run(&[&arguments, more].concat()).ok();
    let frame: Value = serde_json::from_str(&answer.stdout).unwrap();
    let export = [
        "export",
        "colmap",
        "--camera",
        "camera.toml",
        "--out",
        "rest",
    ];
    bench.run(&export).ok();
    let crc = json(bench, "rest/export.json")["calibration_crc32"].clone();
    let [x, y] = [0, 1].map(|axis| frame["principal_point_mm"][axis].clone());
    let mut record = serde_json::json!({
        "sequence": 1, "trigger_us": 0, "outcome": "exposed", "opened_us": 0, "closed_us": 10_000,
        "centroid_us": 5000, "principal_point_x_mm": x, "principal_point_y_mm": y,
        "principal_point_frame_sigma_mm": 1e-5, "principal_point_common_sigma_mm": 0,
        "focus_shift_mm": frame["focus_shift_um"].as_f64().unwrap() / 1000.0,
        "focus_convention": "A", "centroid_after_opening_s": frame["centroid_time_s"],
        "variance_mm2": frame["travel_variance_mm2"], "third_moment_mm3": 0,
        "fourth_moment_mm4": 0, "compensated_vh_per_s": frame["vh_per_s"], "faults": [],
        "flags": [], "fault_codes": "", "calibration_crc32": crc,
    });
    for same in [
        "exposure_s",
        "principal_distance_mm",
        "enlargement",
        "model",
        "kernel",
        "left_out_nm",
        "opening_offset_mm",
        "travel_mm",
        "centroid_offset_mm",
    ] {
        record[same] = frame[same].clone();
    }
    for name in NAMES {
        if record.get(name).is_none() {
            record[name] = Value::Null;
        }
    }
    let file = serde_json::json!({ "records": [record] });
    fs::write(bench.path("records.json"), file.to_string()).unwrap();
}

#[test]
fn cost_of_one_camera_is_stated_and_the_way_is_advised() {
    let bench = Bench::with(IXM, b"");
    one_record(
        &bench,
        &["--opening-offset-mm", "0.145", "--focus-shift-um", "10"],
    );
    let answer = bench.run(&export("colmap", "records.json", &[])).ok();
    let statement = json(&bench, "colmap/export.json");
    let frames = &statement["frames"];
    assert!((frames["largest_offset_um"].as_f64().unwrap() - 188.6655).abs() < 1e-3);
    assert!((frames["largest_offset_px"].as_f64().unwrap() - 50.177).abs() < 1e-3);
    assert!((frames["largest_enlargement"].as_f64().unwrap() - 1.9466e-4).abs() < 1e-8);
    assert_eq!(frames["one_camera_is_enough"], false);
    assert!(frames["way"].as_str().unwrap().contains("camera per image"));
    assert!(
        answer.stdout.contains("189 µm (50.1770 px), sequence 1"),
        "{}",
        answer.stdout
    );
    let residual = statement["residual_max_um"].as_f64().unwrap();
    let at_rest = json(&bench, "rest/export.json")["residual_max_um"].clone();
    assert!(residual <= at_rest.as_f64().unwrap() + 5e-3);
    let cameras = fs::read_to_string(bench.path("colmap/cameras.txt")).unwrap();
    assert!(
        cameras.contains(" 7117.5319") && cameras.contains(" 5282.17938"),
        "{cameras}"
    );

    one_record(&bench, &["--opening-offset-mm", "-0.04366552"]);
    let answer = bench.run(&export("colmap", "records.json", &[])).ok();
    let frames = &json(&bench, "colmap/export.json")["frames"];
    assert_eq!(frames["one_camera_is_enough"], true);
    assert!(
        answer.stdout.contains("one camera for all frames"),
        "{}",
        answer.stdout
    );
    let limit = export("colmap", "records.json", &["--max-residual-um", "0.1"]);
    bench.run(&limit).failed(1, &["0.19", "--max-residual-um"]);
}
