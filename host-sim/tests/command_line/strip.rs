//! `strip`: a simulated strip of frames over ground control.

use std::fs;

use crate::command_line::support::{Answer, Bench};

const PAPER: &str = include_str!("../../scenarios/yuan-2012.toml");
const STRIP: &str = include_str!("../../scenarios/strip.toml");
const CAMERA: &str = include_str!("../../scenarios/cameras/yuan-2012.toml");

/// Returns a folder with the paper's scenario, changed.
fn bench(scenario: &str) -> Bench {
    let bench = Bench::new();
    fs::create_dir(bench.path("cameras")).unwrap();
    fs::write(bench.path("cameras/yuan-2012.toml"), CAMERA).unwrap();
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    bench
}

fn repeat(bench: &Bench, more: &[&str]) -> Answer {
    let mut arguments = vec!["strip", "--scenario", "scenario.toml"];
    arguments.extend(more);
    if !more.contains(&"--repetitions") {
        arguments.extend(["--repetitions", "3"]);
    }
    if !more.contains(&"--out") {
        arguments.extend(["--out", "report"]);
    }
    bench.run(&arguments)
}

/// Returns the line of a key in its table, with another value.
fn with(table: &str, key: &str, value: &str) -> String {
    let mut inside = false;
    let mut found = false;
    let lines: Vec<String> = PAPER
        .lines()
        .map(|line| {
            if line.starts_with('[') {
                inside = line.starts_with(&format!("[{table}]"));
            }
            if inside && line.split(' ').next() == Some(key) {
                found = true;
                return format!("{key} = {value}");
            }
            line.to_owned()
        })
        .collect();
    assert!(found, "{table}.{key}");
    lines.join("\n") + "\n"
}

fn refused(scenario: &str, words: &[&str]) {
    let bench = bench(scenario);
    let answer = repeat(&bench, &[]);
    answer.refused(words);
    answer.refused(&["scenario.toml"]);
}

#[test]
fn papers_scenario_has_a_complete_report_that_says_what_survives() {
    let bench = bench(PAPER);
    let answer = repeat(&bench, &[]).ok();
    for words in ["ground error", "check points", "exact", "0.87"] {
        assert!(answer.stdout.contains(words), "{words}:\n{}", answer.stdout);
    }
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("report/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["control_points"], 10);
    assert_eq!(summary["check_points"], 49);
    assert_eq!(summary["repetitions"], 3);
    let models = summary["models"].as_array().unwrap();
    let keys: Vec<&str> = models
        .iter()
        .map(|m| m["model"].as_str().unwrap())
        .collect();
    assert_eq!(
        keys,
        [
            "none", "static", "printed", "focus", "scale", "five", "exact"
        ]
    );
    for model in models {
        assert!(model["check_m"]["lower"].as_f64().unwrap() > 0.0);
        assert!(model["most_iterations"].as_u64().unwrap() <= 6);
    }
    let page = fs::read_to_string(bench.path("report/report.html")).unwrap();
    assert!(page.contains(summary["headline"].as_str().unwrap()));
    for verdict in summary["verdicts"].as_array().unwrap() {
        let sentence = verdict["sentence"].as_str().unwrap();
        assert!(answer.stdout.contains(sentence), "{sentence}");
    }
    assert_eq!(page.matches("<svg").count(), 3);
    assert!(!page.contains("NaN"));
    let rows = fs::read_to_string(bench.path("report/repetitions.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 3 * 7);
}

#[test]
fn same_seed_gives_the_same_bytes_and_another_seed_others() {
    let bench = bench(PAPER);
    for (folder, seed) in [("one", "7"), ("two", "7"), ("three", "8")] {
        repeat(&bench, &["--seed", seed, "--out", folder]).ok();
    }
    for file in [
        "report.html",
        "summary.json",
        "repetitions.csv",
        "convergence.svg",
    ] {
        let read = |folder: &str| fs::read(bench.path(&format!("{folder}/{file}"))).unwrap();
        assert!(read("one") == read("two"), "{file}");
        assert!(read("one") != read("three"), "{file}");
    }
}

#[test]
fn noise_floor_and_the_flight_without_focus_shift_stand_beside_the_paper() {
    let bench = bench(PAPER);
    let answer = repeat(&bench, &["--repetitions", "20"]).ok();
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("report/summary.json")).unwrap()).unwrap();
    // √2 · √(0.12² + (5.2 µm · 2000 m / 100 mm)²).
    let floor_m = summary["noise_floor_m"].as_f64().unwrap();
    assert!((floor_m - 0.2246).abs() < 1e-4, "{floor_m}");
    assert!(answer.stdout.contains("make 0.225 m at check points"));
    let ratio = |models: &str, name: &str| {
        let models = summary[models].as_array().unwrap();
        let model = models.iter().find(|model| model["model"] == name);
        model.unwrap()["check_ratio"]["value"].as_f64().unwrap()
    };
    // The gain comes from the focus shift: without it no model has one.
    for model in ["scale", "five", "exact"] {
        assert!(ratio("models", model) < 0.95, "{model}");
        assert!(ratio("models_without_focus_shift", model) > 0.99, "{model}");
    }
    let page = fs::read_to_string(bench.path("report/report.html")).unwrap();
    assert!(page.contains("The flight without focus shift") && page.contains("Noise floor"));
}

#[test]
fn flight_without_focus_shift_has_no_other_beside_it() {
    let bench = bench(&with("truth", "focus_shift_um", "0.0").replace(
        "\n[correction]\nfocus_shift_um = 42.0",
        "\n[correction]\nfocus_shift_um = 0.0",
    ));
    repeat(&bench, &[]).ok();
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("report/summary.json")).unwrap()).unwrap();
    assert!(summary["models_without_focus_shift"].is_null());
    let page = fs::read_to_string(bench.path("report/report.html")).unwrap();
    assert!(!page.contains("The flight without focus shift"));
}

#[test]
fn scenario_of_a_mission_is_told_by_name() {
    let mission = include_str!("../../scenarios/mission.toml");
    for command in ["strip", "flight"] {
        let bench = bench(mission);
        let strip = [command, "--scenario", "scenario.toml", "--out", "report"];
        let answer = bench.run(&strip);
        answer.refused(&[
            "scenario.toml: is the scenario of a mission",
            "host-sim mission",
        ]);
        assert!(!bench.path("report").exists());
    }
}

#[test]
fn control_points_outside_the_frame_are_named() {
    let far = PAPER.replace("x_m = 250.0", "x_m = 2500.0");
    refused(
        &far,
        &[
            "control.points",
            "outside every frame: 5 (x_m = 2500, y_m = 240)",
            "-8",
        ],
    );
    // All control points are given in millimetres.
    let millimetres = PAPER
        .lines()
        .map(|line| {
            if line.trim_start().starts_with("{ id") {
                line.replace(".0, y_m", "000.0, y_m")
                    .replace(".0, z_m", "000.0, z_m")
            } else {
                line.to_owned()
            }
        })
        .collect::<Vec<_>>()
        .join("\n");
    refused(
        &millimetres,
        &["control.points", "outside every frame: 1 (x_m = -640000"],
    );
}

#[test]
fn places_in_kilometres_are_noticed() {
    let mut kilometres = String::new();
    for line in PAPER.lines() {
        if line.trim_start().starts_with("{ id") {
            let parts: Vec<&str> = line.split(", ").collect();
            let scaled = parts.iter().map(|part| match part.split_once(" = ") {
                Some((key, value)) if key == "x_m" || key == "y_m" => {
                    format!("{key} = {}", value.parse::<f64>().unwrap() / 1000.0)
                }
                _ => (*part).to_owned(),
            });
            kilometres += &scaled.collect::<Vec<_>>().join(", ");
        } else {
            kilometres += line;
        }
        kilometres += "\n";
    }
    refused(
        &kilometres,
        &["control.points", "x_m and y_m", "kilometres?"],
    );
}

#[test]
fn too_few_points_and_repeated_ids_are_refused() {
    let mut control = 0;
    let two: Vec<&str> = PAPER
        .lines()
        .filter(|line| {
            control += usize::from(line.trim_start().starts_with("{ id"));
            !line.trim_start().starts_with("{ id") || control <= 2
        })
        .collect();
    refused(
        &two.join("\n"),
        &["control.points", "2 points", "at least 3"],
    );
    let twice = PAPER.replace("id = \"2\"", "id = \"1\"");
    refused(
        &twice,
        &["control.points.1.id = \"1\"", "earlier point", "line "],
    );
}

#[test]
fn frames_with_too_few_points_are_named() {
    let is_point = |line: &str| line.trim_start().starts_with("{ id");
    let stays = |line: &str| {
        let number = line.split('"').nth(1).unwrap().trim_end_matches('M');
        number.parse::<u32>().is_ok_and(|number| number % 2 == 1)
    };
    let few: Vec<&str> = STRIP
        .lines()
        .filter(|line| !is_point(line) || stays(line))
        .collect();
    let camera = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/cameras/phase-one-ixm-rs150f-50.toml"
    );
    let scenario = few
        .join("\n")
        .replace("../cameras/phase-one-ixm-rs150f-50.toml", camera);
    refused(
        &scenario,
        &["control.points", "frame ", "of 12 shows ", "at least 3"],
    );
}

#[test]
fn standard_deviations_of_zero_or_less_are_refused() {
    for value in ["0.0", "-1.0", "nan"] {
        let single = ["out of range", "line ", value];
        let both = |key, range| [&single[..], &[key, range]].concat();
        refused(
            &with("image", "sigma_um", value),
            &both("image.sigma_um", "0.01 to 100 µm"),
        );
        refused(
            &with("control", "sigma_m", value),
            &both("control.sigma_m", "0.001 to 10 m"),
        );
        for (key, range) in [
            ("position_sigma_m", "0.001 to 1000 m"),
            ("attitude_sigma_deg", "0.0001 to 10 °"),
        ] {
            let text = with("pos", key, &format!("[0.1, {value}, 0.1]"));
            let lower = value.replace("nan", "NaN").replace(".0", "");
            refused(&text, &["out of range", "line ", key, range, &lower]);
        }
    }
}

#[test]
fn heights_that_cannot_be_metres_are_named() {
    let first = PAPER
        .lines()
        .find(|line| line.trim_start().starts_with("{ id"))
        .unwrap();
    let z = first
        .split("z_m = ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap();
    let point = |value: &str| PAPER.replacen(&format!("z_m = {z} "), &format!("z_m = {value} "), 1);
    refused(
        &point("2100.0"),
        &[
            "control.points.0.z_m = 2100.0",
            "not below the aircraft",
            "2050 m",
            "point 1",
        ],
    );
    refused(
        &point("50000.0"),
        &["z_m = 50000.0", "not below the aircraft"],
    );
    refused(&point("-500.0"), &["z_m = -500.0", "allowed -90 to 190 m"]);
    // A height in kilometres over high terrain: 1.05 for 1050 m.
    let high = PAPER
        .replace("height_m = 50.0 ", "height_m = 1050.0 ")
        .replace("height_m = 2050.0", "height_m = 3050.0")
        .replacen(&format!("z_m = {z} "), "z_m = 1.05 ", 1);
    refused(&high, &["control.points.0.z_m = 1.05", "kilometres?"]);
    refused(
        &with("flight", "height_m", "2.05"),
        &["flight.height_m = 2.05", "50 to 15000 m", "kilometres?"],
    );
    refused(
        &with("flight", "height_m", "2050000.0"),
        &[
            "flight.height_m = 2050000.0",
            "50 to 15000 m",
            "millimetres?",
        ],
    );
    refused(
        &with("terrain", "height_m", "2040.0"),
        &["terrain.height_m = 2040.0", "reaches the aircraft"],
    );
    refused(
        &with("flight", "exposure_s", "5.0"),
        &["flight.exposure_s = 5.0", "0.000001 to 0.1 s"],
    );
}

#[test]
fn exposures_that_the_camera_cannot_make_are_refused() {
    refused(
        &with("flight", "speed_m_s", "30.0"),
        &["speed_m_s", "V/H", "0.05 to 0.17"],
    );
}

#[test]
fn unknown_keys_and_missing_cameras_are_refused() {
    refused(
        &PAPER.replace("sigma_um =", "sigma_mm ="),
        &["sigma_mm", "unknown field", "line "],
    );
    refused(
        &with("pos", "position_sigma_m", "\"open\""),
        &["position_sigma_m", "free", "line "],
    );
    refused(
        &PAPER.replace("cameras/yuan-2012.toml", "cameras/nowhere.toml"),
        &["camera = \"cameras/nowhere.toml\"", "not there", "line "],
    );
    refused(
        &with("flight", "frames", "5"),
        &["flight.frames = 5", "base_m"],
    );
    let bench = bench(PAPER);
    bench
        .run(&["strip", "--scenario", "nowhere.toml", "--out", "report"])
        .refused(&["nowhere.toml"]);
    assert!(!bench.path("report").exists());
}

#[test]
fn free_orientations_are_an_error_that_names_the_pair() {
    let free = with("pos", "position_sigma_m", "\"free\"");
    let attitude = PAPER
        .lines()
        .find(|line| line.starts_with("attitude_sigma_deg"))
        .unwrap();
    refused(
        &free.replace(attitude, "attitude_sigma_deg = \"free\""),
        &[
            "position_sigma_m, attitude_sigma_deg = \"free\"",
            "K_m0",
            "Z_S",
        ],
    );
}

#[test]
fn folder_that_cannot_be_written_is_an_io_failure() {
    let bench = bench(PAPER);
    fs::write(bench.path("report"), "a file").unwrap();
    repeat(&bench, &[]).failed(3, &["report"]);
}

#[test]
fn former_name_of_the_command_gives_the_same_bytes() {
    let bench = bench(PAPER);
    let answers = ["strip", "flight"].map(|command| {
        let options = ["--scenario", "scenario.toml", "--repetitions", "2", "--out"];
        let answer = bench.run(&[&[command], &options[..], &[command]].concat());
        let summary = fs::read(bench.path(&format!("{command}/summary.json"))).unwrap();
        (answer.ok().stdout, summary)
    });
    assert_eq!(answers[0], answers[1]);
    let help = bench.run(&["--help"]).ok().stdout;
    assert!(help.contains("[alias: flight]"), "{help}");
}

#[test]
fn strip_is_adjusted_with_any_seed() {
    let camera = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/cameras/phase-one-ixm-rs150f-50.toml"
    );
    let bench = bench(&STRIP.replace("../cameras/phase-one-ixm-rs150f-50.toml", camera));
    for seed in ["1", "2", "3", "18446744073709551615"] {
        repeat(&bench, &["--seed", seed]).ok();
    }
}
