//! `calibrate resection` and `calibrate bundle` on published real data.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::command_line::calibration_files::assert_certified;
use crate::command_line::support::{Answer, Bench};

const OLYMPUS: &str = "name = \"Olympus C4040Z\"\nprincipal_distance_mm = 7.5\n[sensor]\n\
                       width_px = 2272\nheight_px = 1704\npixel_um = 3.1911032863849766\n";

const STRASBOURG: &str = "name = \"Strasbourg\"\nprincipal_distance_mm = 123.9392\n[sensor]\n\
                          width_px = 8858\nheight_px = 12996\npixel_um = 6.0\n";

const BOARD: &str = "name = \"Board\"\nprincipal_distance_mm = 8.0\n[sensor]\n\
                     width_px = 640\nheight_px = 480\npixel_um = 10.0\n";

/// Returns a bench with the camera and the files of a data set.
fn bench(camera: &str, set: &str) -> Bench {
    let bench = Bench::with(camera, b"");
    let data = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../crates/adjustment/tests/data")
        .join(set);
    for name in ["image_points.csv", "object_points.csv"] {
        fs::copy(data.join(name), bench.path(name)).unwrap();
    }
    bench
}

fn run(bench: &Bench, method: &str, more: &[&str]) -> Answer {
    let arguments = [
        "calibrate",
        method,
        "image_points.csv",
        "--points",
        "object_points.csv",
        "--camera",
        "camera.toml",
        "--out",
        "out",
    ];
    bench.run(&[&arguments, more].concat())
}

fn summary(bench: &Bench) -> Value {
    serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap()
}

#[test]
fn checkerboard_by_resection() {
    let bench = bench(BOARD, "checkerboard");
    run(
        &bench,
        "resection",
        &["--estimate", "f,x0,y0,k1,k2,p1,p2,b1"],
    )
    .ok();
    let summary = summary(&bench);
    assert_eq!(summary["method"], "resection");
    assert_eq!(summary["redundancy"], 440);
    assert!((summary["sigma0"].as_f64().unwrap() - 1.039_59).abs() < 1e-5);
    assert!((summary["rms_point_px"].as_f64().unwrap() - 0.139_317).abs() < 1e-6);
    let camera = fs::read_to_string(bench.path("out/camera.toml")).unwrap();
    assert!(
        camera.contains("principal_distance_mm = 8.0475"),
        "{camera}"
    );
    for name in [
        "residuals.csv",
        "covariance.csv",
        "points.csv",
        "certificate.html",
    ] {
        assert!(bench.path("out").join(name).exists(), "{name}");
    }
    assert_certified(&bench, "out");
}

#[test]
fn strasbourg_shows_the_check_point_that_does_not_fit() {
    let bench = bench(STRASBOURG, "strasbourg");
    let answer = run(&bench, "bundle", &["--estimate", "none"]).ok();
    assert!(
        answer.stderr.contains("check point 410: y is off by"),
        "{}",
        answer.stderr
    );
    let summary = summary(&bench);
    // Before six image points are rejected: the published adjustment.
    let all = &summary["all_observations"];
    assert!((all["sigma0"].as_f64().unwrap() - 1.1786).abs() < 5e-5);
    assert_eq!(all["redundancy"], 1261);
    assert_eq!(summary["rejected"].as_array().unwrap().len(), 6);
}

#[test]
fn camcal_with_all_observations() {
    let camera = format!("{OLYMPUS}[fmc]\nstroke_mm = 0.1\n");
    let bench = bench(&camera, "camcal");
    run(&bench, "bundle", &["--keep-all"]).ok();
    let summary = summary(&bench);
    assert!((0.1 * summary["sigma0"].as_f64().unwrap() - 0.168_901).abs() < 5e-7);
    let parameter = |name: &str| {
        let all = summary["parameters"].as_array().unwrap();
        all.iter().find(|one| one["name"] == name).unwrap().clone()
    };
    let f = parameter("principal_distance_mm");
    assert!((f["value"].as_f64().unwrap() - 7.4574).abs() < 5e-5);
    assert!((f["sigma"].as_f64().unwrap() - 0.00109).abs() < 5e-6);
    assert_certified(&bench, "out");
}

#[test]
fn distortion_that_the_camera_cannot_use_is_reported_all_the_same() {
    // The default stroke of 4 mm reaches far beyond a sensor of 7 mm.
    let bench = bench(OLYMPUS, "camcal");
    let answer = run(&bench, "bundle", &[]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(
        answer.stderr.contains("no camera file is written"),
        "{}",
        answer.stderr
    );
    assert!(
        answer.stderr.contains("control point 1004 does not fit"),
        "{}",
        answer.stderr
    );
    assert!(bench.path("out/summary.json").exists());
    assert!(!bench.path("out/camera.toml").exists());
}

#[test]
fn files_that_cannot_be_used_are_refused() {
    let bench = bench(BOARD, "checkerboard");
    let refused = |method: &str, more: &[&str], words: &[&str]| {
        run(&bench, method, more).refused(words);
        assert!(!bench.path("out").exists());
    };
    refused("bundle", &["--estimate", "f,k9"], &["k9 is none of f, x0"]);
    refused("bundle", &["--estimate", "f,f"], &["f appears twice"]);
    refused("bundle", &["--prior", "f=0"], &["not greater than 0"]);
    refused("bundle", &["--prior", "f"], &["f is not NAME=SIGMA"]);
    refused(
        "bundle",
        &["--estimate", "f,k1", "--prior", "k2=1e-9"],
        &["--prior", "k2 is not estimated", "--estimate"],
    );
    let points = fs::read_to_string(bench.path("object_points.csv")).unwrap();
    let replaced = |from: &str, to: &str| {
        fs::write(
            bench.path("object_points.csv"),
            points.replacen(from, to, 1),
        )
        .unwrap();
    };
    replaced("\n5,", "\nfive,");
    refused(
        "resection",
        &[],
        &[
            "image_points.csv, line 6",
            "point 5",
            "no known coordinates",
        ],
    );
    replaced(",control", ",ctrl");
    refused(
        "bundle",
        &[],
        &[
            "object_points.csv, line 2",
            "role = \"ctrl\"",
            "approximate",
        ],
    );
    replaced("0.0254", "NaN");
    refused("bundle", &[], &["line 3", "x_m = \"NaN\""]);
    fs::write(bench.path("object_points.csv"), &points).unwrap();
    let images = "image,point,x_mm,y_mm\n1,1,90.55,-1.2\n";
    fs::write(bench.path("image_points.csv"), images).unwrap();
    refused(
        "bundle",
        &[],
        &["line 2", "x_mm = 90.55", "off the sensor", "µm or px"],
    );
}
