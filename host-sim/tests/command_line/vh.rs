//! V/H as a number, as a fraction, and as ground speed and height.

use crate::command_line::support::{Answer, Bench};

const SPEED_AND_HEIGHT: [&str; 4] = ["--ground-speed", "70", "--height", "700"];

/// Runs a command on the bench's camera with an exposure of 1/200 s and more arguments.
fn run(bench: &Bench, command: &str, more: &[&str]) -> Answer {
    let mut arguments = vec![command, "--camera", "camera.toml", "--exposure", "1/200"];
    arguments.extend(more);
    if let "correct" | "distort" | "reference" = command {
        arguments.push("points.csv");
    }
    bench.run(&arguments)
}

#[test]
fn every_way_to_say_vh_gives_the_same_answer_in_every_command() {
    let bench = Bench::new();
    for command in ["frame", "correct", "distort", "reference", "smear"] {
        let expected = run(&bench, command, &["--vh", "0.1"]).ok().stdout;
        assert!(!expected.is_empty());
        for way in [&["--vh", "70/700"][..], &SPEED_AND_HEIGHT] {
            assert_eq!(run(&bench, command, way).ok().stdout, expected, "{command}");
        }
    }
    let mesh = |way: &[&str], out| {
        let more = [way, &["--format", "gpu", "--spacing", "1024", "--out", out]].concat();
        run(&bench, "mesh", &more).ok();
        std::fs::read(bench.path(out).join("mesh.json")).unwrap()
    };
    let expected = mesh(&["--vh", "0.1"], "a");
    assert_eq!(mesh(&SPEED_AND_HEIGHT, "b"), expected);
}

#[test]
fn exactly_one_way_is_taken() {
    let bench = Bench::new();
    for command in ["frame", "correct", "distort", "reference", "smear"] {
        run(&bench, command, &[]).refused(&["--vh <PER_S>|--ground-speed <M_S>"]);
        let both = [&["--vh", "0.1"][..], &SPEED_AND_HEIGHT].concat();
        run(&bench, command, &both).refused(&["--vh", "cannot be used with", "--ground-speed"]);
        run(&bench, command, &["--ground-speed", "70"]).refused(&["--height"]);
        run(&bench, command, &["--height", "700"]).refused(&["--ground-speed"]);
        run(&bench, command, &["--vh", "0.1", "--height", "700"]).refused(&["--height"]);
    }
}

#[test]
fn numbers_that_are_no_speed_or_height_are_refused() {
    let bench = Bench::new();
    for vh in ["70/0", "0/0", "70/", "/700", "70/700/2", "fast", "nan"] {
        run(&bench, "frame", &["--vh", vh]).refused(&["--vh", vh]);
    }
    for (speed, height, option) in [
        ("nan", "700", "--ground-speed"),
        ("70", "0", "--height"),
        ("70", "-700", "--height"),
        ("70", "inf", "--height"),
    ] {
        run(
            &bench,
            "frame",
            &["--ground-speed", speed, "--height", height],
        )
        .refused(&[option]);
    }
}

#[test]
fn vh_outside_the_limits_is_refused_with_the_options_that_gave_it() {
    let bench = Bench::new();
    run(&bench, "frame", &["--vh", "140/700"])
        .refused(&["--vh: V/H 0.2 is outside 0.05 to 0.17 1/s ([limits] of camera.toml)"]);
    let fast = ["--ground-speed", "140", "--height", "700"];
    for command in ["frame", "correct", "smear"] {
        run(&bench, command, &fast)
            .refused(&["--ground-speed over --height: V/H 0.2 is outside 0.05 to 0.17 1/s"]);
    }
    run(
        &bench,
        "frame",
        &["--ground-speed", "-70", "--height", "700"],
    )
    .refused(&["V/H -0.1 is outside"]);
}

#[test]
fn bench_camera_is_told_vh_in_every_way() {
    let bench = Bench::new();
    let vh =
        |way: &[&str]| bench.run(&[&["camera", "--device", "serial:nowhere", "vh"], way].concat());
    for way in [&["0.1"][..], &["70/700"], &SPEED_AND_HEIGHT] {
        // The port is opened, so the arguments were taken.
        vh(way).failed(3, &["nowhere"]);
    }
    vh(&[]).refused(&["PER_S", "--ground-speed <M_S>"]);
    vh(&["0.1", "--ground-speed", "70", "--height", "700"]).refused(&["cannot be used with"]);
    vh(&["--ground-speed", "70"]).refused(&["--height"]);
    vh(&["7000/70"]).refused(&["vh = 100 is outside"]);
}
