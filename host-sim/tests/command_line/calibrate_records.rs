//! `calibrate bundle --records` on a simulated block.

use std::fs;

use serde_json::Value;

use crate::command_line::calibration_files::assert_certified;
use crate::command_line::flight_block::{Block, RunUp};
use crate::command_line::support::{Answer, Bench};

const FROM_REST: Block = Block {
    run_up: RunUp::FromRest,
    seed: 1,
    fault_mm: 0.0,
    at_trigger: false,
};

fn run(bench: &Bench, more: &[&str]) -> Answer {
    let arguments = [
        "calibrate",
        "bundle",
        "image_points.csv",
        "--points",
        "points.csv",
        "--images",
        "images.csv",
        "--camera",
        "camera.toml",
        "--estimate",
        "x0,y0",
        "--records",
        "records.csv",
        "--out",
        "out",
    ];
    bench.run(&[&arguments, more].concat())
}

fn summary(bench: &Bench) -> Value {
    serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap()
}

fn along_m(summary: &Value, bundle: &str) -> f64 {
    summary[bundle]["check_points"][0].as_f64().unwrap()
}

fn suspects(summary: &Value) -> Vec<String> {
    let list = summary["suspect_records"].as_array().unwrap();
    list.iter()
        .map(|one| one["image"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn records_from_rest_in_wind_move_the_ground_back_by_18_cm() {
    for seed in 1..=4 {
        let bench = Block { seed, ..FROM_REST }.bench();
        let answer = run(&bench, &[]).ok();
        let summary = summary(&bench);
        // By hand: (63.5 - 37.7 µm)/2·700/50 = 18.0 cm.
        let fixed = along_m(&summary, "static_bundle");
        assert!((fixed - 0.18).abs() < 0.03, "{fixed}");
        let with = along_m(&summary, "records");
        assert!(with <= 0.02, "{with}");
        // The static bundle does not show it: 5 % limits of some thousand redundant observations.
        for sigma0 in [&summary["static_bundle"]["sigma0"], &summary["sigma0"]] {
            let sigma0 = sigma0.as_f64().unwrap();
            assert!((sigma0 - 1.0).abs() < 0.03, "{sigma0}");
        }
        assert_eq!(summary["records"]["tested"], 40);
        assert!(
            answer.stdout.contains("Records of the flight") && answer.stdout.contains("static"),
            "{}",
            answer.stdout
        );
        assert!(
            answer.stderr.contains("records of the wrong sign"),
            "{}",
            answer.stderr
        );
        eprintln!("seed {seed}: static {fixed:.4} records {with:.4} {summary:#}");
    }
}
