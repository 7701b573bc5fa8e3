//! Images with known truth: `render`, `compare`, `verify --images`.

use std::fs;

use crate::command_line::support::Bench;

const CAMERA: &str = r#"name = "Small camera"
principal_distance_mm = 20.0
principal_point_mm = [0.02, -0.01]
[sensor]
width_px = 600
height_px = 440
pixel_um = 20.0
[distortion]
k1 = -1.0e-4
p1 = 2.0e-5
[fmc]
axis = "+y"
stroke_mm = 4.0
"#;

const EXPOSURE: [&str; 8] = [
    "--camera",
    "camera.toml",
    "--vh",
    "0.17",
    "--exposure",
    "1/100",
    "--opening-offset-mm",
    "0.3",
];

fn bench() -> Bench {
    Bench::with(CAMERA, b"")
}

fn run(bench: &Bench, command: &str, more: &[&str]) {
    let arguments = [&[command], &EXPOSURE[..], more].concat();
    bench.run(&arguments).ok();
}

fn longest_px(bench: &Bench, folder: &str) -> f64 {
    let text = fs::read(bench.path(&format!("{folder}/summary.json"))).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&text).unwrap();
    assert!(summary["blocks"].as_u64().unwrap() > 40, "{summary}");
    summary["shift_largest_px"].as_f64().unwrap()
}

#[test]
fn rectified_frame_is_the_rendered_answer() {
    let bench = bench();
    run(&bench, "render", &["--out", "scene", "--bands", "3"]);
    for (kernel, limit_px) in [
        ("bicubic", "0.004"),
        ("keys6", "0.0015"),
        ("bilinear", "0.035"),
    ] {
        run(
            &bench,
            "rectify",
            &["--resample", kernel, "--out", kernel, "scene/frame.tif"],
        );
        let rectified = format!("{kernel}/frame.tif");
        let arguments = [
            "compare",
            "scene/rectified.tif",
            &rectified,
            "--out",
            kernel,
        ];
        let limit = ["--max-px", limit_px];
        let answer = bench.run(&[&arguments[..], &limit].concat()).ok();
        assert!(
            answer.stdout.contains("shift, longest"),
            "{}",
            answer.stdout
        );
        assert!(longest_px(&bench, kernel) > 0.0);
    }
    let figure = fs::read_to_string(bench.path("bicubic/shifts.svg")).unwrap();
    assert!(figure.contains("column, px"));
}

/// An exposure that opened 2 µm off has its content a tenth of a pixel off.
#[test]
fn frame_that_is_rectified_as_another_exposure_is_found() {
    let bench = bench();
    run(&bench, "render", &["--out", "scene"]);
    let other: Vec<&str> = EXPOSURE[..6].to_vec();
    let more = [
        "--opening-offset-mm",
        "0.298",
        "--out",
        "other",
        "scene/frame.tif",
    ];
    bench.run(&[&["rectify"], &other[..], &more].concat()).ok();
    let compare = [
        "compare",
        "scene/rectified.tif",
        "other/frame.tif",
        "--out",
        "other",
    ];
    let answer = bench.run(&[&compare[..], &["--max-px", "0.01"]].concat());
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(
        answer.stderr.contains("other/frame.tif"),
        "{}",
        answer.stderr
    );
    // 2 µm of 20 µm, along the rows' axis, and a part of it in the distortion.
    assert!((longest_px(&bench, "other") - 0.1).abs() < 0.01);
}

#[test]
fn image_that_is_half_empty_does_not_pass() {
    let bench = bench();
    run(&bench, "render", &["--out", "scene"]);
    let more = ["--window", "600x440", "--out", "far", "scene/frame.tif"];
    let other = [&EXPOSURE[..6], &["--opening-offset-mm", "1.9"]].concat();
    bench.run(&[&["rectify"], &other[..], &more].concat()).ok();
    let compare = ["compare", "scene/rectified.tif", "far/frame.tif"];
    let answer = bench.run(&[&compare[..], &["--max-grey", "65535"]].concat());
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(answer.stderr.contains("have content"), "{}", answer.stderr);
}

#[test]
fn image_is_seen_through_the_camera() {
    let bench = bench();
    run(
        &bench,
        "render",
        &["--out", "scene", "--bits", "8", "--periods", "24,60"],
    );
    run(
        &bench,
        "render",
        &["--out", "again", "--image", "scene/rectified.tif"],
    );
    run(
        &bench,
        "rectify",
        &["--resample", "keys6", "--out", "out", "again/frame.tif"],
    );
    let compare = [
        "compare",
        "scene/rectified.tif",
        "out/frame.tif",
        "--max-px",
        "0.02",
    ];
    bench.run(&[&compare[..], &["--edge", "24"]].concat()).ok();
}

#[test]
fn images_that_cannot_be_compared_are_refused() {
    let bench = bench();
    run(&bench, "render", &["--out", "scene"]);
    run(&bench, "render", &["--out", "three", "--bands", "3"]);
    let compare = |a: &str, b: &str, more: &[&str]| bench.run(&[&["compare", a, b], more].concat());
    compare("scene/frame.tif", "three/frame.tif", &[]).refused(&[
        "three/frame.tif",
        "3 x 16 bits",
        "1 x 16 bits",
    ]);
    compare("scene/frame.tif", "camera.toml", &[]).refused(&["camera.toml", "not a TIFF"]);
    compare("scene/frame.tif", "none.tif", &[]).refused(&["none.tif"]);
    // Nothing is left to compare.
    let answer = compare(
        "scene/frame.tif",
        "scene/frame.tif",
        &["--edge", "400", "--max-px", "1"],
    );
    assert_eq!(answer.code, 1);
    assert!(
        answer.stderr.contains("nothing to compare"),
        "{}",
        answer.stderr
    );
    let render = [
        "render",
        "--camera",
        "camera.toml",
        "--out",
        "x",
        "--exposure",
        "1/100",
    ];
    let run = |more: &[&str]| bench.run(&[&render[..], more].concat());
    run(&["--vh", "9"]).refused(&["--vh"]);
    run(&["--vh", "0.1", "--periods", "3"]).refused(&["--periods", "12 to 100000"]);
    run(&["--vh", "0.1", "--bands", "2"]).refused(&["--bands"]);
    run(&["--vh", "0.1", "--image", "three/frame.tif", "--scale", "2"]).refused(&[
        "three/frame.tif",
        "600 x 440 px",
        "300 x 220 px",
    ]);
}

#[test]
fn kernels_keep_their_limits_on_a_camera() {
    let bench = bench();
    let arguments = [
        "verify",
        "--images",
        "--camera",
        "camera.toml",
        "--out",
        "report",
    ];
    let answer = bench.run(&arguments).ok();
    for kernel in ["bilinear", "bicubic", "keys6", "lanczos3"] {
        assert!(answer.stdout.contains(kernel), "{}", answer.stdout);
    }
    let text = fs::read(bench.path("report/images.json")).unwrap();
    let results: Vec<serde_json::Value> = serde_json::from_slice(&text).unwrap();
    assert_eq!(results.len(), 4);
    for result in results {
        assert!(result["blocks"].as_u64().unwrap() > 80, "{result}");
        assert!(
            result["mesh_bound_px"].as_f64().unwrap() <= 0.001,
            "{result}"
        );
    }
}
