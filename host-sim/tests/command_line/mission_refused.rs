//! `mission` on scenarios that are refused.

use std::fs;

use crate::command_line::mission::{CAMERA, MISSION, STALL, bench, changed, fly};
use crate::command_line::support::Bench;

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
fn scenario_of_a_strip_is_told_by_name() {
    let bench = bench(include_str!("../../scenarios/strip.toml"));
    let answer = fly(&bench, &[]);
    answer.refused(&[
        "scenario.toml: is the scenario of a strip",
        "host-sim strip",
    ]);
    assert!(!bench.path("report").exists());
}

#[test]
fn unknown_fault_is_named_with_those_there_are() {
    refused_fault(
        "name = \"stall\"",
        "name = \"meteor\"",
        &["meteor", "is not a fault", "vh-drop-out", "uart-cut"],
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
fn fault_of_a_wire_that_there_is_not_is_refused() {
    for (fault, needed) in [
        ("receiver-cut", "receiver = \"nmea\""),
        ("autopilot-flood", "autopilot = \"mavlink\""),
    ] {
        refused_fault(
            "name = \"stall\"\n",
            &format!("name = \"{fault}\"\n"),
            &["fault.0.name", needed],
        );
    }
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
        &["line.baud = 12", "1200 to 115200"],
    );
    refused(
        "receiver = \"nmea\"",
        "receiver = \"morse\"",
        &["morse", "nmea"],
    );
    refused(
        "autopilot = \"mavlink\"",
        "autopilot = \"morse\"",
        &["morse", "mavlink"],
    );
    refused(
        "autopilot_baud = 57600 ",
        "autopilot_baud = 230400 ",
        &["line.autopilot_baud = 230400", "1200 to 115200"],
    );
}

#[test]
fn wire_with_more_messages_than_it_carries_is_refused() {
    // 80 bytes fifty times a second, and ten heights of 44.
    refused(
        "reported_hz = 50.0 ",
        "reported_hz = 67.0 ",
        &[
            "line.autopilot_baud = 57600",
            "carries 5760 bytes per second",
            "are 5800 bytes per second",
            "reported_hz",
        ],
    );
    // Ten speeds of 42 bytes and a time of 50.
    refused(
        "baud = 38400 ",
        "baud = 4600 ",
        &["line.baud = 4600", "carries 460 bytes", "are 470 bytes"],
    );
    let scenario = changed(MISSION, "reported_hz = 50.0 ", "reported_hz = 66.0 ");
    let scenario = changed(&scenario, "exposures = 1000 ", "exposures = 12 ");
    let bench = bench(&changed(&scenario, "baud = 38400 ", "baud = 4800 "));
    fly(&bench, &[]).ok();
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
        &[
            "V/H = 0.3000 1/s",
            "0.05 to 0.17 1/s ([limits] of cameras/mission.toml)",
        ],
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
