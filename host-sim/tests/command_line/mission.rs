//! `mission`: a simulated flight with the camera in the loop.

use std::fs;

use crate::command_line::support::{Answer, Bench};

pub(crate) const MISSION: &str = include_str!("../../scenarios/mission.toml");
pub(crate) const STALL: &str = include_str!("../../scenarios/faults/stall.toml");
pub(crate) const CAMERA: &str = include_str!("../../scenarios/cameras/mission.toml");

/// Returns a folder with the nominal mission's camera and a scenario.
pub(crate) fn bench(scenario: &str) -> Bench {
    let bench = Bench::new();
    fs::create_dir(bench.path("cameras")).unwrap();
    fs::write(bench.path("cameras/mission.toml"), CAMERA).unwrap();
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    bench
}

pub(crate) fn fly(bench: &Bench, more: &[&str]) -> Answer {
    let mut arguments = vec!["mission", "--scenario", "scenario.toml"];
    arguments.extend(more);
    if !more.contains(&"--out") {
        arguments.extend(["--out", "report"]);
    }
    bench.run(&arguments)
}

/// Flies the nominal mission, in which every check must pass.
fn fly_nominal(bench: &Bench, more: &[&str]) -> Answer {
    let mut arguments = vec!["mission"];
    arguments.extend(more);
    bench.run(&arguments).ok()
}

pub(crate) fn changed(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn short_mission_has_a_complete_report() {
    let bench = Bench::new();
    let answer = fly_nominal(&bench, &["--exposures", "6", "--out", "report"]);
    for words in [
        "6 triggers, 6 exposed, 0 refused, 0 unanswered",
        "passed",
        "CRC-32",
    ] {
        assert!(answer.stdout.contains(words), "{words}:\n{}", answer.stdout);
    }
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("report/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["exposed"], 6);
    assert_eq!(summary["passed"], answer.code == 0);
    assert!(summary["pp_error_px"]["max"].as_f64().unwrap() < 0.1);
    for file in ["records.csv", "truth.csv"] {
        let rows = fs::read_to_string(bench.path(&format!("report/{file}"))).unwrap();
        assert_eq!(rows.lines().count(), 7, "{file}");
        assert!(!rows.contains("NaN"));
    }
    let page = fs::read_to_string(bench.path("report/report.html")).unwrap();
    // Frames, histograms and rounds; error/σ of three quantities, and the smear.
    assert_eq!(page.matches("<svg").count(), 7);
    assert!(!page.contains("NaN"));
    let records: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("report/records.json")).unwrap()).unwrap();
    assert_eq!(records["records_crc32"], summary["records_crc32"]);
    let record = &records["records"][0];
    assert_eq!(record["calibration_crc32"], summary["calibration"]["crc32"]);
    let calibration = format!(
        "calibration CRC-32 {}, volatile\n",
        record["calibration_crc32"].as_str().unwrap()
    );
    assert!(answer.stdout.contains(&calibration), "{}", answer.stdout);
    assert!(records["records"][0]["principal_point_y_mm"].is_number());
}

#[test]
fn page_counts_and_explains_the_flags_that_occurred_and_no_others() {
    let quiet = changed(MISSION, "reported_hz = 50.0", "reported_hz = 0.0");
    let quiet_bench = bench(&quiet);
    fly(&quiet_bench, &["--exposures", "3"]).ok();
    let page = fs::read_to_string(quiet_bench.path("report/report.html")).unwrap();
    assert!(page.contains("Refusals and faults: none.") && page.contains("Flags: none."));

    let stalled = bench(&changed(STALL, "../cameras", "cameras"));
    fly(&stalled, &[]).ok();
    let page = fs::read_to_string(stalled.path("report/report.html")).unwrap();
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(stalled.path("report/summary.json")).unwrap()).unwrap();
    let flags = summary["flags"].as_array().unwrap();
    assert!(flags.len() > 1, "{flags:?}");
    for flag in flags {
        let (name, frames) = (flag["name"].as_str().unwrap(), &flag["frames"]);
        let row = format!("<td>{name}</td><td>camera</td><td>{frames} of 24</td>");
        assert!(page.contains(&row), "{row}");
    }
    assert_eq!(page.matches("<td>camera</td>").count(), flags.len());
    assert!(page.contains("<td>the stage stood still</td>"));
}

#[test]
fn same_seed_gives_the_same_bytes_and_another_seed_others() {
    let bench = Bench::new();
    for (folder, seed) in [("one", "7"), ("two", "7"), ("three", "8")] {
        fly_nominal(
            &bench,
            &["--exposures", "3", "--seed", seed, "--out", folder],
        );
    }
    for file in ["report.html", "records.csv", "truth.csv", "summary.json"] {
        let read = |folder: &str| fs::read(bench.path(&format!("{folder}/{file}"))).unwrap();
        assert!(read("one") == read("two"), "{file}");
        assert!(read("one") != read("three"), "{file}");
    }
}

#[test]
fn frame_to_look_at_is_chosen_and_must_exist() {
    let bench = Bench::new();
    fly_nominal(
        &bench,
        &["--exposures", "3", "--frame", "2", "--out", "report"],
    );
    let figure = fs::read_to_string(bench.path("report/timeline.svg")).unwrap();
    assert!(figure.contains("Trigger 2"));
    bench
        .run(&[
            "mission",
            "--exposures",
            "3",
            "--frame",
            "4",
            "--out",
            "other",
        ])
        .refused(&["--frame 4", "3 exposures"]);
}

#[test]
fn fault_without_its_expected_outcome_fails_the_check_and_leaves_the_report() {
    let here = changed(STALL, "../cameras", "cameras");
    let bench = bench(&changed(&here, "fault = \"stall\"", "fault = \"runaway\""));
    let answer = fly(&bench, &["--exposures", "9"]);
    assert_eq!(answer.code, 1);
    assert!(
        answer
            .stderr
            .contains("runaway (11) named within 5 ms: not named")
    );
    assert!(bench.path("report/report.html").exists());
}

#[test]
fn camera_without_a_stage_is_flown_and_its_steps_are_more_than_the_limit_of_smear() {
    let bench = bench(MISSION);
    let tdi = changed(CAMERA, "strategy = \"centred\"", "mechanism = \"tdi\"");
    fs::write(bench.path("cameras/mission.toml"), tdi).unwrap();
    let answer = fly(&bench, &["--exposures", "6"]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    for words in [
        "6 exposed",
        "largest error 0.0000 px",
        "FAILED: smear of all frames",
    ] {
        assert!(answer.stdout.contains(words), "{words}: {}", answer.stdout);
    }
}

#[test]
fn settings_of_camera_prepare_are_flown_and_contradictions_name_both() {
    let bench = bench(MISSION);
    fs::write(
        bench.path("settings.toml"),
        "[drive]\nencoder_step_um = 0.5\n",
    )
    .unwrap();
    let with = ["--exposures", "4", "--settings", "settings.toml"];
    fly(&bench, &with).refused(&[
        "mechanics.encoder_step_um = 0.1",
        "drive.encoder_step_um = 0.5 of settings.toml",
    ]);
    fs::write(
        bench.path("settings.toml"),
        "[drive]\nencoder_side = \"Stage\"\n",
    )
    .unwrap();
    fly(&bench, &with).refused(&[
        "mechanics.encoder_side = \"screw\"",
        "drive.encoder_side = Stage of settings.toml",
    ]);
    // The play of a screw may be another than its setting.
    fs::write(
        bench.path("settings.toml"),
        "speed_tolerance_percent = 2\n[drive]\nplay_um = 1.1\n",
    )
    .unwrap();
    let answer = fly(&bench, &with);
    assert!(answer.stdout.contains("4 exposed"), "{}", answer.stderr);
    fs::write(bench.path("settings.toml"), "speed_tolerance = 2\n").unwrap();
    fly(&bench, &with).refused(&["settings.toml", "no setting speed_tolerance"]);
    fly(&bench, &["--settings", "nowhere.toml"]).refused(&["nowhere.toml"]);
}
