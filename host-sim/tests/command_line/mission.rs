//! `mission`: a simulated flight with the camera in the loop.

use std::fs;

use crate::command_line::support::{Answer, Bench};

const MISSION: &str = include_str!("../../scenarios/mission.toml");
const STALL: &str = include_str!("../../scenarios/faults/stall.toml");
const CAMERA: &str = include_str!("../../scenarios/cameras/mission.toml");

/// Returns a folder with the nominal mission's camera and a scenario.
fn bench(scenario: &str) -> Bench {
    let bench = Bench::new();
    fs::create_dir(bench.path("cameras")).unwrap();
    fs::write(bench.path("cameras/mission.toml"), CAMERA).unwrap();
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    bench
}

fn fly(bench: &Bench, more: &[&str]) -> Answer {
    let mut arguments = vec!["mission", "--scenario", "scenario.toml"];
    arguments.extend(more);
    if !more.contains(&"--out") {
        arguments.extend(["--out", "report"]);
    }
    bench.run(&arguments)
}

/// Flies the nominal mission, of which every finding must pass but one: its predicted smear is too
/// small as long as the σ of V/H leaves out the air.
fn fly_nominal(bench: &Bench, more: &[&str]) -> Answer {
    let mut arguments = vec!["mission"];
    arguments.extend(more);
    let answer = bench.run(&arguments);
    let failed: Vec<&str> = answer
        .stdout
        .lines()
        .filter(|line| line.starts_with("FAILED: "))
        .collect();
    assert_eq!(
        answer.code,
        i32::from(!failed.is_empty()),
        "{}",
        answer.stderr
    );
    for line in failed {
        assert!(line.contains("smear: above the predicted one"), "{line}");
    }
    answer
}

fn changed(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

/// Checks that the nominal mission with another text in it is refused, and nothing is written.
fn refused(from: &str, to: &str, words: &[&str]) {
    let bench = bench(&changed(MISSION, from, to));
    let answer = fly(&bench, &[]);
    answer.refused(words);
    answer.refused(&["scenario.toml, line "]);
    assert!(!bench.path("report").exists());
}

/// Checks that a fault scenario with another text in its fault is refused.
fn refused_fault(from: &str, to: &str, words: &[&str]) {
    let here = changed(STALL, "../cameras", "cameras");
    let bench = bench(&changed(&here, from, to));
    let answer = fly(&bench, &[]);
    answer.refused(words);
    answer.refused(&["scenario.toml, line ", "fault.0"]);
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
    assert!(records["records"][0]["principal_point_y_mm"].is_number());
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
fn unknown_fault_is_named_with_those_there_are() {
    refused_fault(
        "name = \"stall\"",
        "name = \"meteor\"",
        &["meteor", "is no fault", "vh-drop-out", "uart-cut"],
    );
}

#[test]
fn fault_out_of_its_range_is_refused() {
    refused_fault(
        "size = 50.0",
        "size = -3.0",
        &["size = -3.0", "0.01 to 1000 N"],
    );
    refused_fault("size = 50.0", "size = nan", &["size = nan"]);
    refused_fault(
        "at_frame = 8",
        "at_frame = 25",
        &["at_frame = 25", "1 to 24 frames"],
    );
    refused_fault("at_frame = 8", "at_frame = 0", &["at_frame = 0"]);
    refused_fault(
        "onset_s = 0.02 ",
        "onset_s = 9.0 ",
        &["onset_s = 9.0", "from the frame's trigger"],
    );
    refused_fault(
        "duration_s = 2.0",
        "duration_s = 0.0",
        &["duration_s = 0.0"],
    );
}

#[test]
fn fault_of_a_source_that_is_not_there_or_not_of_one_is_refused() {
    let of_vh = "name = \"vh-jump\"\n";
    refused_fault(
        "name = \"stall\"\n",
        &format!("{of_vh}source = \"terrain\"\n"),
        &["fault.0.source = \"terrain\"", "no [[vh]] has"],
    );
    refused_fault(
        "name = \"stall\"\n",
        "name = \"stall\"\nsource = \"altimeter\"\n",
        &["fault.0.source", "not for stall"],
    );
    refused_fault(
        "name = \"stall\"\n",
        "name = \"stall\"\nof = \"height\"\n",
        &["fault.0.of", "not for stall"],
    );
}

#[test]
fn cut_has_its_duration_as_its_size_and_nothing_else() {
    refused_fault(
        "name = \"stall\"\n",
        "name = \"uart-cut\"\n",
        &["fault.0.duration_s", "lasts for its size"],
    );
    let without = |text: &str| changed(text, "duration_s = 2.0\n", "");
    let here = changed(&without(STALL), "../cameras", "cameras");
    let bench = bench(&changed(
        &here,
        "name = \"stall\"\nat_frame = 8\nonset_s = 0.02 ",
        "name = \"uart-cut\"\nat_frame = 8\n# ",
    ));
    let bench_of = |size: &str| {
        let text = fs::read_to_string(bench.path("scenario.toml")).unwrap();
        fs::write(
            bench.path("scenario.toml"),
            changed(&text, "size = 50.0", &format!("size = {size}")),
        )
        .unwrap();
        fly(&bench, &[])
    };
    bench_of("2000.0").refused(&["fault.0.size = 2000.0", "0.001 to 1000 s"]);
}

#[test]
fn line_that_carries_what_there_is_not_is_refused() {
    refused(
        "carries = [\"vh\", ",
        "carries = [\"gyro\", ",
        &["line.carries", "gyro", "attitude", "altimeter"],
    );
    refused(
        "baud = 38400 ",
        "baud = 12 ",
        &["line.baud = 12", "1200 to 921600"],
    );
    refused(
        "receiver = \"whole\"",
        "receiver = \"morse\"",
        &["morse", "nmea"],
    );
}

#[test]
fn fault_without_onset_is_refused() {
    let here = changed(
        &changed(STALL, "../cameras", "cameras"),
        "at_frame = 8\n",
        "",
    );
    let bench = bench(&changed(&here, "onset_s = 0.02", "# "));
    fly(&bench, &[]).refused(&["needs at_frame or onset_s"]);
}

#[test]
fn unknown_outcome_is_named_with_those_there_are() {
    refused_fault(
        "fault = \"stall\"",
        "fault = \"jam\"",
        &["expect.fault = \"jam\"", "wrong direction"],
    );
    refused_fault(
        "state = \"fault\"",
        "state = \"sleep\"",
        &["expect.state", "fly-back"],
    );
    refused_fault(
        "refused = \"stall\"",
        "refused = \"mood\"",
        &["expect.refused", "overlap"],
    );
    refused_fault(
        "flag = \"no compensation\"",
        "flag = \"red\"",
        &["expect.flag", "encoder glitch"],
    );
    refused_fault(
        "flag = \"no compensation\"",
        "vh_from = \"moon\"",
        &["expect.vh_from", "altimeter"],
    );
    refused_fault(
        "flag = \"no compensation\"",
        "smear_px = -1.0",
        &["expect.smear_px = -1.0", "0 to 1000 px"],
    );
}

#[test]
fn triggers_faster_than_the_mechanism_are_refused() {
    refused(
        "forward_overlap_percent = 90.0",
        "interval_s = 0.05",
        &[
            "flight.interval_s = 0.05",
            "triggers every 50.0 ms",
            "overlap",
        ],
    );
    refused(
        "forward_overlap_percent = 90.0",
        "forward_overlap_percent = 99.0",
        &["forward_overlap_percent = 99.0", "would overlap"],
    );
    refused(
        "forward_overlap_percent = 90.0",
        "forward_overlap_percent = 90.0\ninterval_s = 1.0",
        &["contradicts forward_overlap_percent"],
    );
}

#[test]
fn what_contradicts_the_camera_file_is_refused() {
    refused(
        "speed_m_s = 96.0",
        "speed_m_s = 240.0",
        &["V/H = 0.3000 1/s", "0.05 to 0.17 1/s"],
    );
    refused(
        "exposure_s = 0.003333333",
        "exposure_s = 0.05",
        &["exposure_s = 0.05", "0.001 to 0.02 s"],
    );
    refused(
        "cameras/mission.toml",
        "cameras/none.toml",
        &["cameras/none.toml", "not there"],
    );
}

#[test]
fn stage_that_cannot_make_the_travel_is_refused() {
    let bench = bench(MISSION);
    let short = changed(CAMERA, "stroke_mm = 4.0", "stroke_mm = 0.05");
    fs::write(bench.path("cameras/mission.toml"), short).unwrap();
    let answer = fly(&bench, &[]);
    answer.refused(&["scenario.toml, line ", "stroke"]);
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
    fs::write(bench.path("settings.toml"), "speed_tolerance_percent = 2\n").unwrap();
    let answer = fly(&bench, &with);
    assert!(answer.stdout.contains("4 exposed"), "{}", answer.stderr);
    fs::write(bench.path("settings.toml"), "speed_tolerance = 2\n").unwrap();
    fly(&bench, &with).refused(&["settings.toml", "no setting speed_tolerance"]);
    fly(&bench, &["--settings", "nowhere.toml"]).refused(&["nowhere.toml"]);
}

#[test]
fn what_is_no_scenario_is_refused() {
    refused(
        "height_m = 900.0 ",
        "height_m = 900000.0 ",
        &["flight.height_m", "in millimetres?"],
    );
    refused(
        "exposures = 1000",
        "exposures = 0",
        &["flight.exposures = 0"],
    );
    refused("rate_hz = 10.0", "rate_hz = 0.0", &["vh.0.rate_hz = 0.0"]);
    refused("source = \"altimeter\"", "source = \"gut\"", &["vh"]);
    refused(
        "mass_kg = 0.3",
        "mass_kg = -1.0",
        &["mechanics", "mass_kg = -1"],
    );
    refused("jitter_us = 20.0", "jitters_us = 20.0", &["jitters_us"]);
    refused(
        "relief_m = 10.0",
        "relief_m = 900.0",
        &["reaches the aircraft"],
    );
    let bench = Bench::new();
    bench
        .run(&["mission", "--scenario", "nowhere.toml", "--out", "report"])
        .refused(&["nowhere.toml"]);
    bench
        .run(&["mission", "--exposures", "0", "--out", "report"])
        .refused(&["--exposures"]);
}
