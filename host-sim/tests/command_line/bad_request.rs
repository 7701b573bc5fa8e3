//! Wrong exposures and options.

use crate::command_line::support::{Bench, CAMERA, POINTS};

#[test]
fn vh_and_exposure_outside_the_limits_are_refused_with_the_limits() {
    let bench = Bench::new();
    for command in ["correct", "distort", "reference", "frame"] {
        for vh in ["0.18", "0.049", "0", "-0.1"] {
            bench.points(command, &["--vh", vh]).refused(&[
                "--vh",
                vh,
                "0.05 to 0.17",
                "camera.toml",
            ]);
        }
        for exposure in ["1/10", "0.0009", "1/2000"] {
            bench.points(command, &["--exposure", exposure]).refused(&[
                "--exposure",
                "0.001 to 0.02",
                "camera.toml",
            ]);
        }
        for edge in [
            ["--vh", "0.17"],
            ["--vh", "0.05"],
            ["--exposure", "0.02"],
            ["--exposure", "1/1000"],
        ] {
            bench.points(command, &edge).ok();
        }
    }
}

#[test]
fn what_is_no_number_is_refused() {
    let bench = Bench::new();
    for exposure in ["1/0", "0", "-1/200", "nan", "inf", "fast", ""] {
        bench
            .points("correct", &["--exposure", exposure])
            .refused(&["--exposure"]);
    }
    for option in ["--vh", "--opening-offset-mm", "--focus-shift-um"] {
        for value in ["nan", "inf", "x", ""] {
            bench.points("correct", &[option, value]).refused(&[option]);
        }
    }
}

#[test]
fn stroke_too_short_for_the_plan_is_refused_with_what_is_needed() {
    let short = CAMERA.replace("stroke_mm = 4.0", "stroke_mm = 0.3");
    let bench = Bench::with(&short, POINTS.as_bytes());
    // 17 mm/s: 0.1445 mm of ramp, 0.085 mm of settling, 0.34 mm of exposure.
    for command in ["correct", "distort", "reference", "frame"] {
        bench
            .points(command, &["--vh", "0.17", "--exposure", "0.02"])
            .refused(&["stroke_mm", "camera.toml", "0.1500 mm"]);
    }
    let from_rest = short.replace("centred", "from-rest");
    Bench::with(&from_rest, POINTS.as_bytes())
        .points("frame", &["--vh", "0.17"])
        .refused(&["stroke_mm"]);
    // A given opening offset needs room for the exposure alone.
    let offset = ["--vh", "0.1", "--exposure", "0.01", "--opening-offset-mm"];
    bench
        .points("frame", &[&offset[..], &["-0.05"]].concat())
        .ok();
    bench
        .points("frame", &[&offset[..], &["0.06"]].concat())
        .refused(&["stroke_mm"]);
    Bench::new()
        .points("frame", &["--opening-offset-mm", "-2.1"])
        .refused(&["-2.1"]);
}

#[test]
fn speed_beyond_the_stages_is_refused_in_both_directions() {
    let slow = CAMERA.replace("stroke_mm = 4.0", "stroke_mm = 4.0\nmax_speed_mm_s = 12.0");
    let bench = Bench::with(&slow, POINTS.as_bytes());
    for command in ["correct", "distort", "reference", "frame"] {
        for (direction, wanted) in [("forward", " 17"), ("reverse", "-17")] {
            let asked = ["--vh", "0.17", "--direction", direction];
            bench.points(command, &asked).refused(&[
                "max_speed_mm_s",
                "camera.toml",
                wanted,
                "12 mm/s",
            ]);
        }
        bench.points(command, &["--vh", "0.12"]).ok();
        bench
            .points(command, &["--direction", "sideways"])
            .refused(&["--direction", "forward", "reverse"]);
    }
    // Jerk makes the run-up longer: 17 mm/s over 17√(17/10⁴) = 0.7009 mm of ramp instead of 0.1445
    // mm.
    let jerk = CAMERA.replace(
        "strategy = \"centred\"",
        "strategy = \"from-rest\"\njerk_mm_s3 = 1.0e4",
    );
    let bench = Bench::with(&jerk, POINTS.as_bytes());
    let answer = bench.points("frame", &["--vh", "0.17"]).ok();
    assert!(answer.stdout.contains("0.785928 mm"), "{}", answer.stdout);
    let short = jerk.replace("stroke_mm = 4.0", "stroke_mm = 3.0");
    Bench::with(&short, POINTS.as_bytes())
        .points("frame", &["--vh", "0.17"])
        .refused(&["stroke_mm", "1.5719 mm"]);
}

#[test]
fn focus_shift_beyond_one_per_cent_is_refused() {
    Bench::new()
        .points("correct", &["--focus-shift-um", "1001"])
        .refused(&["--focus-shift-um", "-1000 to 1000"]);
}

#[test]
fn fitted_model_of_a_camera_without_one_is_refused() {
    let camera = CAMERA.split("[fitted]").next().unwrap();
    let bench = Bench::with(camera, POINTS.as_bytes());
    for command in ["correct", "distort", "reference", "frame"] {
        bench
            .points(command, &["--model", "fitted"])
            .refused(&["camera.toml", "[fitted]"]);
    }
}

#[test]
fn unknown_options_commands_and_devices_are_refused() {
    let bench = Bench::new();
    bench.run(&["corect"]).refused(&["corect"]);
    bench.run(&[]).refused(&["Usage"]);
    bench
        .points("correct", &["--model", "best"])
        .refused(&["best", "exact"]);
    bench
        .points("correct", &["--device", "teapot"])
        .refused(&["teapot", "sil"]);
    bench.run(&["correct", "points.csv"]).refused(&["--camera"]);
}

#[test]
fn more_tdi_rows_than_can_be_counted_are_refused_with_the_options() {
    let tdi = CAMERA
        .replace("mechanism = \"stage\"", "mechanism = \"tdi\"")
        .replace(
            "principal_distance_mm = 100.0",
            "principal_distance_mm = 1000.0",
        )
        .replace("stroke_mm = 4.0", "stroke_mm = 50.0")
        .replace("[0.05, 0.17]", "[0.05, 1.0]")
        .replace("strategy = \"centred\"\n", "");
    // 1000 mm · 0.9 1/s · 0.02 s: 18 mm, 2057 rows of 8.75 µm.
    Bench::with(&tdi, POINTS.as_bytes())
        .points("frame", &["--vh", "0.9", "--exposure", "0.02"])
        .refused(&["--vh and --exposure", "TDI rows", "0 to 1024"]);
}
