//! `block`: simulated blocks with and without the records of the flight.

use std::fs;

use serde_json::Value;

use crate::command_line::support::{Answer, Bench};

const CAMERA: &str = include_str!("../../cameras/phase-one-ixm-rs150f-50.toml");
const BLOCK: &str = include_str!("../../scenarios/block/ixm-50.toml");
const STRIP: &str = include_str!("../../scenarios/strip.toml");

/// Returns a folder with the scenario of the iXM, smaller, with a line of it changed.
fn bench(line: &str, changed: &str) -> Bench {
    let bench = Bench::new();
    fs::write(bench.path("ixm.toml"), CAMERA).unwrap();
    let small = BLOCK
        .replace("../../cameras/phase-one-ixm-rs150f-50.toml", "ixm.toml")
        .replace("points_per_frame = 80", "points_per_frame = 20")
        .replace("frames = 10 ", "frames = 5 ");
    let scenario = small.replace(line, changed);
    assert!(line == changed || scenario != small, "{line}");
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    bench
}

fn run(bench: &Bench, more: &[&str]) -> Answer {
    let arguments = ["block", "--scenario", "scenario.toml", "--runs", "2"];
    bench.run(&[&arguments, more].concat())
}

fn summary(bench: &Bench, folder: &str) -> Value {
    let path = bench.path(&format!("{folder}/summary.json"));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn report_says_what_records_buy_and_files_have_the_same_numbers() {
    let bench = bench("records_along_m = 0.02", "records_along_m = 0.04");
    let answer = run(&bench, &["--out", "out"]).ok();
    for words in [
        "static, control, shifts",
        "the records buy 1",
        "the static bundle",
        "distortion recentred or not",
        "passed  no good record is named",
    ] {
        assert!(answer.stdout.contains(words), "{words}:\n{}", answer.stdout);
    }
    let widest = answer.stdout.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(80), "{}", answer.stdout);
    let summary = summary(&bench, "out");
    assert_eq!(
        (&summary["frames"], &summary["passed"]),
        (&20.into(), &true.into())
    );
    let variants = summary["variants"].as_array().unwrap();
    assert_eq!(variants.len(), 6);
    let fixed = variants[0]["along_m"]["value"].as_f64().unwrap();
    assert!((fixed - 0.18).abs() < 0.05, "{fixed}");
    let runs = fs::read_to_string(bench.path("out/runs.csv")).unwrap();
    assert_eq!(runs.lines().count(), 1 + 2 * 6);
    let page = fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.contains("the records buy 1") && page.contains("<svg"));
    assert!(bench.path("out/check-points.svg").exists());
}

#[test]
fn same_seed_gives_the_same_files_on_any_number_of_threads() {
    let bench = bench("points = 5", "points = 0");
    for (folder, threads) in [("one", "1"), ("two", "2")] {
        let arguments = [
            "block",
            "--scenario",
            "scenario.toml",
            "--runs",
            "3",
            "--out",
            folder,
        ];
        let mut command = bench.command(&arguments);
        let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(
            bench.path(folder).join("summary.json").exists(),
            "{output:?}"
        );
    }
    for name in [
        "summary.json",
        "runs.csv",
        "report.html",
        "check-points.svg",
    ] {
        let [one, two] =
            ["one", "two"].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
        assert!(one == two, "{name}");
    }
    // Without control, variants that need it are left out.
    assert_eq!(
        summary(&bench, "one")["variants"].as_array().unwrap().len(),
        3
    );
}

#[test]
fn limit_that_is_exceeded_is_a_failed_check() {
    let bench = bench("records_along_m = 0.02", "records_along_m = 0.001");
    let answer = run(&bench, &["--out", "out"]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(
        answer.stderr.contains("records, along the strips"),
        "{}",
        answer.stderr
    );
    assert_eq!(summary(&bench, "out")["passed"], false);
}

#[test]
fn values_out_of_range_are_refused_with_key_value_and_range() {
    for (line, changed, words) in [
        (
            "strips = 4",
            "strips = 0",
            &["block.strips = 0", "1 to 20 strips"][..],
        ),
        (
            "wind_m_s = 15.0",
            "wind_m_s = 70.0",
            &[
                "flight.wind_m_s = 70.0",
                "5 m/s over ground",
                "10 to 350 m/s",
            ],
        ),
        (
            "exposure_s = [0.0033333, 0.0033333]",
            "exposure_s = [0.004, 0.002]",
            &[
                "flight.exposure_s = [0.004, 0.002]",
                "shortest, then the longest",
            ],
        ),
        (
            "exposure_s = [0.0033333, 0.0033333]",
            "exposure_s = [0.0033333, 0.09]",
            &[
                "flight.height_m = 700.0",
                "exposure_s = 0.09",
                "the camera refuses the exposure",
            ],
        ),
        (
            "image_um = 1.128",
            "image_um = 0.0",
            &["sigma.image_um = 0.0", "0.01 to 100 µm"],
        ),
        (
            "points = 5",
            "points = 2",
            &["control.points = 2", "allowed 0, or 3 to 50"],
        ),
        (
            "[limits]",
            "[wrong_record]\nframe = 21\nby_um = 40.0\n[limits]",
            &["wrong_record.frame = 21", "1 to 20 of the block's frames"],
        ),
        (
            "[limits]",
            "[wrong_record]\nframe = 3\nby_um = 4000.0\n[limits]",
            &["wrong_record.by_um = 4000.0", "-500 to 500 µm"],
        ),
        (
            "run_up = \"from-rest\"",
            "run_up = \"sideways\"",
            &["run_up", "from-rest"],
        ),
        (
            "relief_m = 56.0",
            "relief_m = 800.0",
            &["terrain.height_m", "reaches the aircraft"],
        ),
        (
            "side_overlap_percent = 30",
            "side_overlap = 30",
            &["side_overlap"],
        ),
    ] {
        let bench = bench(line, changed);
        let answer = run(&bench, &["--out", "out"]);
        answer.refused(words);
        answer.refused(&["scenario.toml"]);
        assert!(!bench.path("out").exists(), "{changed}");
    }
}

#[test]
fn scenario_of_a_strip_is_refused_by_its_name() {
    let bench = Bench::new();
    fs::write(bench.path("scenario.toml"), STRIP).unwrap();
    run(&bench, &[]).refused(&["is the scenario of a strip", "a block has [block]"]);
    fs::write(bench.path("scenario.toml"), BLOCK).unwrap();
    bench
        .run(&["strip", "--scenario", "scenario.toml", "--out", "out"])
        .refused(&["is the scenario of a block", "a strip has [control]"]);
}
