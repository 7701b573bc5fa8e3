//! `records`: records that are on the disk before the camera forgets them.

use std::fs;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::serial::Port;
use crate::command_line::support::Bench;

const MISSION: &str = include_str!("../../scenarios/faults/uart-cut.toml");
const CAMERA: &str = include_str!("../../scenarios/cameras/mission.toml");

#[test]
fn records_of_a_flight_whose_link_was_cut_are_fetched_later_and_once() {
    let bench = Bench::new();
    let port = Port::with_camera(FakeCamera::new());
    fs::create_dir(bench.path("cameras")).unwrap();
    fs::create_dir(bench.path("faults")).unwrap();
    fs::write(bench.path("cameras/mission.toml"), CAMERA).unwrap();
    // The link is cut from the second frame to the end.
    let cut = MISSION
        .replace("receiver = \"nmea\"", "receiver = \"whole\"")
        .replace("at_frame = 9", "at_frame = 2")
        .replace("onset_s = 0.04 ", "onset_s = 0.0 ")
        .replace("size = 14.01 ", "size = 900.0 ");
    fs::write(bench.path("faults/cut.toml"), cut).unwrap();
    let device = port.device();
    let flown = bench.run(&[
        "mission",
        "--scenario",
        "faults/cut.toml",
        "--exposures",
        "4",
        "--device",
        &device,
        "--out",
        "flight",
    ]);
    assert_eq!(flown.code, 1, "{}{}", flown.stdout, flown.stderr);
    assert!(flown.stdout.contains("1 of 4 triggers"), "{}", flown.stdout);

    let fetched = bench
        .run(&["records", "--device", &device, "--out", "kept"])
        .ok();
    assert!(
        fetched.stdout.contains("3 records, of triggers 2 to 4"),
        "{}",
        fetched.stdout
    );
    let csv = fs::read_to_string(bench.path("kept/records.csv")).unwrap();
    let sequences: Vec<&str> = csv
        .lines()
        .skip(1)
        .map(|row| row.split(',').next().unwrap())
        .collect();
    assert_eq!(sequences, ["2", "3", "4"]);
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("kept/records.json")).unwrap()).unwrap();
    assert_eq!(json["records"].as_array().unwrap().len(), 3);

    // The camera has forgotten the records, so the files must not be replaced.
    bench
        .run(&["records", "--device", &device, "--out", "kept"])
        .refused(&["records.csv", "another folder"]);
    let again = bench
        .run(&["records", "--device", &device, "--out", "empty"])
        .ok();
    assert_eq!(again.stdout, "no records\n");
}

#[test]
fn camera_that_has_not_flown_in_this_process_has_no_records() {
    let bench = Bench::new();
    bench
        .run(&["records", "--out", "kept"])
        .refused(&["--device serial:PATH"]);
    bench
        .run(&["records", "--device", "sil", "--out", "kept"])
        .refused(&["sil", "--device serial:PATH"]);
    assert!(!bench.path("kept").exists());
}
