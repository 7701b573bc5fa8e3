//! `smear`: numbers, files and refusals.

use std::fs;

use crate::command_line::support::{Answer, Bench, CAMERA};

/// Camera of 100 mm, 80.64 mm square, without distortion.
const SQUARE: &str = "name = \"Square\"\nprincipal_distance_mm = 100.0\n\
                      [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";

/// Option, value, and the largest smear published for it, µm.
const TERMS: [(&str, &str, &str); 8] = [
    ("--vh-error-percent", "1", "0.333"),
    ("--relief-percent", "10", "3.704"),
    ("--pitch-deg", "1", "0.531"),
    ("--roll-deg", "1", "0.240"),
    ("--drift-deg", "5", "2.908"),
    ("--pitch-rate-deg-s", "1", "6.829"),
    ("--roll-rate-deg-s", "1", "6.829"),
    ("--yaw-rate-deg-s", "1", "3.317"),
];

fn smear(bench: &Bench, more: &[&str]) -> Answer {
    let exposure = [
        "smear",
        "--camera",
        "camera.toml",
        "--vh",
        "0.1",
        "--exposure",
        "1/300",
    ];
    bench.run(&[&exposure, more].concat())
}

#[test]
fn every_term_alone_and_all_together_are_tabled() {
    let bench = Bench::with(SQUARE, b"");
    for (option, value, expected) in TERMS {
        let answer = smear(&bench, &[option, value]).ok();
        let tables = answer.tables();
        // Two lines of headings, a rule, the term, and all together.
        assert_eq!([tables.len(), tables[0].len()], [1, 5], "{}", answer.stdout);
        for row in &tables[0][3..] {
            // The value appears as predicted and as simulated.
            assert_eq!(
                row.matches(expected).count(),
                if row.contains("everywhere") { 3 } else { 2 },
                "{row}"
            );
        }
    }
    let all: Vec<&str> = TERMS
        .iter()
        .flat_map(|(option, value, _)| [*option, *value])
        .collect();
    let answer = smear(&bench, &all).ok();
    for (_, _, expected) in TERMS {
        assert!(answer.stdout.contains(expected));
    }
    assert!(answer.stdout.contains("all together"));
    assert!(smear(&bench, &[]).ok().stdout.contains("0.000"));
}

#[test]
fn lens_of_the_camera_file_is_in_the_simulation() {
    let bench = Bench::with(CAMERA, b"");
    let answer = smear(&bench, &["--pitch-rate-deg-s", "-1"]).ok();
    assert!(
        answer.stdout.contains("which alone leaves 0."),
        "{}",
        answer.stdout
    );
    assert!(!answer.stdout.contains("which alone leaves 0.000"));
}

#[test]
fn folder_holds_points_summary_and_figures() {
    let bench = Bench::with(SQUARE, b"");
    fs::create_dir(bench.path("out")).unwrap();
    fs::write(bench.path("out/mine.txt"), "kept").unwrap();
    smear(
        &bench,
        &["--out", "out", "--pitch-deg", "1", "--yaw-rate-deg-s", "-2"],
    )
    .ok();
    let mut files: Vec<String> = fs::read_dir(bench.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    let expected = [
        "mine.txt",
        "smear-pitch-deg.svg",
        "smear-yaw-rate-deg-s.svg",
        "smear.csv",
        "smear.svg",
        "summary.json",
    ];
    assert_eq!(files, expected);

    let text = fs::read_to_string(bench.path("out/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["terms"][1]["option"], "yaw-rate-deg-s");
    assert_eq!(summary["terms"][1]["value"], -2.0);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert!((number(&summary["compensated_um"]) - 33.333).abs() < 1e-3);
    assert!((number(&summary["terms"][0]["max_um"]) - 0.5313).abs() < 1e-4);
    let all = &summary["all"];
    assert!((number(&all["max_px"]) * 8.75 - number(&all["max_um"])).abs() < 1e-9);
    assert!(number(&all["bound_um"]) >= number(&all["max_um"]) - 1e-4);

    let mut points = csv::Reader::from_path(bench.path("out/smear.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = points.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 3 * 441);
    // The terms add up, to first order.
    let component = |row: &csv::StringRecord| row[4].parse::<f64>().unwrap();
    for ((pitch, yaw), all) in rows.iter().zip(&rows[441..]).zip(&rows[882..]) {
        assert_eq!(
            (&pitch[0], &yaw[0], &all[0]),
            ("pitch-deg", "yaw-rate-deg-s", "all")
        );
        assert!((component(pitch) + component(yaw) - component(all)).abs() < 1e-4);
    }

    let svg = fs::read_to_string(bench.path("out/smear.svg")).unwrap();
    assert!(svg.contains("Residual smear: pitch 1°, yaw rate -2°/s"));
    assert!(!svg.contains("NaN"));
}

#[test]
fn what_is_not_believable_is_refused_with_option_value_and_range() {
    let bench = Bench::with(SQUARE, b"");
    for (option, value, range) in [
        ("--vh-error-percent", "51", "-50 to 50"),
        ("--relief-percent", "100", "-100 to 90"),
        ("--relief-percent", "1e300", "-100 to 90"),
        ("--pitch-deg", "-45.1", "-45 to 45"),
        ("--roll-deg", "90", "-45 to 45"),
        ("--drift-deg", "46", "-45 to 45"),
        ("--pitch-rate-deg-s", "60.5", "-60 to 60"),
        ("--roll-rate-deg-s", "-61", "-60 to 60"),
        ("--yaw-rate-deg-s", "360", "-60 to 60"),
    ] {
        let shown = if value == "1e300" { "1000" } else { value };
        smear(&bench, &[option, value, "--out", "out"]).refused(&[option, shown, range]);
    }
    for (option, _, _) in TERMS {
        for value in ["nan", "inf", "x", ""] {
            smear(&bench, &[option, value]).refused(&[option]);
        }
    }
    let exposure = |vh, exposure| {
        bench.run(&[
            "smear",
            "--camera",
            "camera.toml",
            "--vh",
            vh,
            "--exposure",
            exposure,
        ])
    };
    exposure("0.31", "1/300").refused(&[
        "--vh",
        "0.31",
        "0.01 to 0.3",
        "default limits; camera.toml",
    ]);
    exposure("-0.1", "1/300").refused(&["--vh", "-0.1", "0.01 to 0.3"]);
    exposure("0.1", "1/10").refused(&[
        "--exposure",
        "0.1",
        "1/5000 to 1/30",
        "default limits; camera.toml",
    ]);
    exposure("0.1", "0").refused(&["--exposure"]);
    bench
        .run(&[
            "smear",
            "--camera",
            "no.toml",
            "--vh",
            "0.1",
            "--exposure",
            "1/300",
        ])
        .refused(&["no.toml"]);
    assert_eq!(
        bench.files(),
        ["camera.toml", "points.csv"],
        "no folder is made"
    );
}

#[test]
fn horizon_on_the_sensor_is_refused_with_both_angles() {
    let wide = SQUARE.replace("100.0", "40.0");
    let bench = Bench::with(&wide, b"");
    smear(&bench, &["--pitch-deg", "30", "--roll-deg", "-35"]).refused(&[
        "--pitch-deg = 30",
        "--roll-deg = -35",
        "horizon",
        "0.1 at least",
    ]);
}

#[test]
fn folder_that_cannot_be_written_is_an_io_failure() {
    let bench = Bench::with(SQUARE, b"");
    fs::write(bench.path("file"), "").unwrap();
    smear(&bench, &["--out", "file"]).failed(3, &["file"]);
    smear(&bench, &["--out", "file/deeper"]).failed(3, &["file/deeper"]);
    fs::create_dir_all(bench.path("out/smear.svg")).unwrap();
    smear(&bench, &["--out", "out"]).failed(3, &["smear.svg"]);
}
