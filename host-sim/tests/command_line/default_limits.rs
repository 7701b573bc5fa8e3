//! Limits of a camera file that states none.

use crate::command_line::support::{Bench, CAMERA, POINTS};

const LIMITS: &str = "[limits]\nvh_per_s = [0.05, 0.17]\nexposure_s = [0.001, 0.02]\n";

/// Returns a camera without `[limits]`, one text of it replaced by another.
fn without_limits(from: &str, to: &str) -> Bench {
    assert!(CAMERA.contains(LIMITS) && CAMERA.contains(from));
    let camera = CAMERA.replace(LIMITS, "").replace(from, to);
    Bench::with(&camera, POINTS.as_bytes())
}

fn plain() -> Bench {
    without_limits("Test camera", "Test camera without limits")
}

#[test]
fn vh_and_exposures_of_ordinary_flights_are_taken() {
    let bench = plain();
    // A helicopter, a survey aircraft, a jet; a short and a long exposure.
    for vh in ["0.01", "20/1000", "70/700", "0.25", "0.3"] {
        for exposure in ["1/5000", "1/1000", "1/60", "1/30"] {
            for command in ["correct", "distort", "reference", "frame"] {
                let asked = ["--vh", vh, "--exposure", exposure];
                bench.points(command, &asked).ok();
            }
        }
    }
}

#[test]
fn refusal_says_that_the_limits_are_the_defaults() {
    let bench = plain();
    for command in ["correct", "distort", "reference", "frame"] {
        for vh in ["0.31", "0.0099"] {
            bench.points(command, &["--vh", vh]).refused(&[&format!(
                "--vh: V/H {vh} is outside 0.01 to 0.3 1/s (default limits; camera.toml has no [limits])"
            )]);
        }
        bench.points(command, &["--exposure", "1/10"]).refused(&[
            "--exposure: 0.1 s is outside 1/5000 to 1/30 s (default limits; camera.toml has no [limits])",
        ]);
    }
    // One of the two is written.
    let half = without_limits("[fitted]", "[limits]\nvh_per_s = [0.05, 0.17]\n[fitted]");
    half.points("frame", &["--vh", "0.2"])
        .refused(&["0.05 to 0.17 1/s ([limits] of camera.toml)"]);
    half.points("frame", &["--exposure", "1/10"])
        .refused(&["1/5000 to 1/30 s (default limits; [limits] of camera.toml has no exposure_s)"]);
}

#[test]
fn exposure_that_the_mechanism_cannot_take_is_refused_for_the_mechanism() {
    let slow = without_limits("stroke_mm = 4.0", "stroke_mm = 4.0\nmax_speed_mm_s = 12.0");
    slow.points("frame", &["--vh", "0.12"]).ok();
    slow.points("frame", &["--vh", "0.2"])
        .refused(&["max_speed_mm_s is too small for --vh 0.2", "12 mm/s"]);
    let short = without_limits("stroke_mm = 4.0", "stroke_mm = 0.3");
    short.points("frame", &["--vh", "0.1"]).ok();
    short
        .points("frame", &["--vh", "0.3", "--exposure", "1/30"])
        .refused(&["stroke_mm is too short for --vh 0.3", "0.1500 mm"]);
}

#[test]
fn budget_is_of_the_exposures_that_the_mechanism_can_take() {
    for (from, to) in [
        ("Test camera", "Test camera"),
        ("stroke_mm = 4.0", "stroke_mm = 4.0\nmax_speed_mm_s = 12.0"),
        ("stroke_mm = 4.0", "stroke_mm = 0.3"),
        (
            "mechanism = \"stage\"\nstrategy = \"centred\"",
            "mechanism = \"tdi\"",
        ),
    ] {
        without_limits(from, to)
            .run(&["budget", "--camera", "camera.toml"])
            .ok();
    }
}

#[test]
fn camera_is_prepared_up_to_what_its_stage_can_fly() {
    // The camera is checked before the port, which is not there, is opened.
    let prepare = |bench: &Bench| {
        std::fs::write(bench.path("flight.toml"), "trigger_interval_s = 1.0\n").unwrap();
        bench.run(&[
            "camera",
            "--device",
            "serial:nowhere",
            "prepare",
            "--camera",
            "camera.toml",
            "--settings",
            "flight.toml",
        ])
    };
    let answer = prepare(&plain());
    answer.failed(3, &["nowhere"]);
    assert!(!answer.stderr.contains("note:"), "{}", answer.stderr);
    let slow = "stroke_mm = 4.0\nmax_speed_mm_s = 12.0";
    prepare(&without_limits("stroke_mm = 4.0", slow)).failed(
        3,
        &[
            "nowhere",
            "the mechanism can fly V/H up to 0.1",
            "less than the default limits",
        ],
    );
    // Limits that the file states are not changed.
    let written = CAMERA.replace("stroke_mm = 4.0", slow);
    prepare(&Bench::with(&written, b"")).refused(&["camera.toml", "12 mm/s"]);
}
