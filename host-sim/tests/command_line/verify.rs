//! `verify`: the comparison of cameras with the strict solver, and its report.

use std::fs;

use crate::command_line::support::{Bench, CAMERA};

#[test]
fn five_published_cameras_pass_and_the_report_is_complete() {
    let bench = Bench::new();
    let answer = bench
        .run(&["verify", "--device", "sil", "--out", "report"])
        .ok();
    assert!(
        answer.stdout.lines().next().unwrap().contains("sil"),
        "{}",
        answer.stdout
    );
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("report/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["points"], 264_600);
    assert!(summary["device"].as_str().unwrap().contains("sil"));
    assert!(summary["max_error_nm"].as_f64().unwrap() <= 1.5);
    let cameras = summary["cameras"].as_array().unwrap();
    assert_eq!(cameras.len(), 5);
    for camera in cameras {
        assert_eq!(camera["points"], 52_920);
        for key in [
            "max_error_nm",
            "rms_error_nm",
            "static_max_um",
            "printed_max_um",
        ] {
            assert!(camera[key].as_f64().unwrap() > 0.0, "{key}");
        }
        let name = camera["name"].as_str().unwrap();
        assert!(answer.stdout.contains(name), "{name}");
        let page = fs::read_to_string(bench.path("report/report.html")).unwrap();
        assert!(page.contains(name), "{name}");
    }
    let frames = fs::read_to_string(bench.path("report/frames.csv")).unwrap();
    assert_eq!(frames.lines().count(), 1 + 600);
    assert_readme_quotes(&summary, &frames);
    let figure = bench.path("report/phase-one-ixm-rs150f-50-mm-dynamic-change.svg");
    let up_to_date = fs::read_to_string(figure).unwrap()
        == include_str!("../../../docs/figures/dynamic-change.svg");
    assert!(
        up_to_date,
        "the README's figure is out of date: copy it from the report"
    );
}

/// Checks that the README quotes the largest errors of the camera and of the static correction, the
/// latter with a centred run-up as well.
fn assert_readme_quotes(summary: &serde_json::Value, frames: &str) {
    let readme = include_str!("../../../README.md").replace('\n', " ");
    let static_max_um = summary["cameras"]
        .as_array()
        .unwrap()
        .iter()
        .map(|camera| camera["static_max_um"].as_f64().unwrap())
        .fold(0.0, f64::max);
    let mut frames = csv::Reader::from_reader(frames.as_bytes());
    let names = frames.headers().unwrap().clone();
    let column = |name| names.iter().position(|column| column == name).unwrap();
    let (strategy, error_um) = (column("strategy"), column("static_max_um"));
    let centred_nm = frames
        .records()
        .map(Result::unwrap)
        .filter(|frame| &frame[strategy] == "centred")
        .map(|frame| 1e3 * frame[error_um].parse::<f64>().unwrap())
        .fold(0.0, f64::max);
    for quoted in [
        format!("falls on that position, it is wrong by {centred_nm:.2} nm"),
        format!(
            "largest error of a distortion {:.2} nm",
            summary["max_error_nm"].as_f64().unwrap()
        ),
        format!("calibration is off by up to {static_max_um:.2} µm"),
        "264,600 coordinates".to_owned(),
    ] {
        assert!(readme.contains(&quoted), "README: {quoted}");
    }
}

#[test]
fn camera_of_ones_own_is_verified_alone() {
    let bench = Bench::with(CAMERA, b"");
    let answer = bench
        .run(&["verify", "--device", "sil", "--camera", "camera.toml"])
        .ok();
    assert!(answer.stdout.contains("Test camera"), "{}", answer.stdout);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
}

#[test]
fn stroke_too_short_for_the_grid_is_bad_input() {
    let camera = CAMERA.replace("stroke_mm = 4.0", "stroke_mm = 0.3");
    Bench::with(&camera, b"")
        .run(&["verify", "--device", "sil", "--camera", "camera.toml"])
        .refused(&["Test camera", "stroke"]);
}

#[test]
fn other_files_of_the_report_folder_are_left_alone() {
    let bench = Bench::new();
    fs::create_dir(bench.path("report")).unwrap();
    fs::write(bench.path("report/notes.txt"), "mine").unwrap();
    bench
        .run(&[
            "verify",
            "--device",
            "sil",
            "--camera",
            "camera.toml",
            "--out",
            "report",
        ])
        .ok();
    assert_eq!(
        fs::read_to_string(bench.path("report/notes.txt")).unwrap(),
        "mine"
    );
}

#[test]
fn answer_of_the_readme_is_the_one_that_is_given() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../");
    let readme = include_str!("../../../README.md");
    let (_, shown) = readme.split_once("```csv\n").unwrap();
    let (shown, _) = shown.split_once("```").unwrap();
    let (_, command) = readme
        .split_once("target/release/host-sim correct")
        .unwrap();
    let (command, _) = command.split_once("```").unwrap();
    let arguments: Vec<_> = command
        .split_whitespace()
        .filter(|word| *word != "\\")
        .map(|word| {
            if word.contains(".toml") || word.contains(".csv") {
                format!("{root}{word}")
            } else {
                word.to_owned()
            }
        })
        .collect();
    let mut all = vec!["correct"];
    all.extend(arguments.iter().map(String::as_str));
    assert_eq!(Bench::new().run(&all).ok().stdout, shown);
}
