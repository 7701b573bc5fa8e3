//! `records`: records that are on the disk before the camera forgets them.

use std::fs;
use std::sync::atomic::{AtomicU32, Ordering};

use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::io::link::after_reset::{FlightAfterReset, WithoutEyes};
use fmc_camera::io::link::message::Answer;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::serial::Port;
use crate::command_line::support::Bench;

const MISSION: &str = include_str!("../../scenarios/faults/uart-cut.toml");
const CAMERA: &str = include_str!("../../scenarios/cameras/mission.toml");

/// Flies four frames, of which the records of the last three are not fetched. Returns the device.
pub(crate) fn fly(bench: &Bench, port: &Port) -> String {
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
    device
}

#[test]
fn records_of_a_flight_whose_link_was_cut_are_fetched_later_and_once() {
    let bench = Bench::new();
    let port = Port::with_camera(FakeCamera::new());
    let device = fly(&bench, &port);
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

/// Number of the flight of a camera that is prepared anew after each record that is fetched.
static FLIGHT: AtomicU32 = AtomicU32::new(1);

#[test]
fn records_are_not_taken_for_those_of_a_flight_that_is_prepared_meanwhile() {
    let bench = Bench::new();
    let mut camera = FakeCamera::new();
    camera.change = |answer| match answer {
        Answer::FrameRecord(Some(_)) => {
            FLIGHT.fetch_add(1, Ordering::Relaxed);
        }
        Answer::Status(status) => status.after_reset.flight = FLIGHT.load(Ordering::Relaxed),
        _ => {}
    };
    let port = Port::with_camera(camera);
    let device = fly(&bench, &port);
    // The camera has them still when they are fetched again.
    for _ in 0..2 {
        bench
            .run(&["records", "--device", &device, "--out", "kept"])
            .failed(3, &["another flight", "fetch them again"]);
        assert!(!bench.path("kept").exists());
    }
}

#[test]
fn time_without_eyes_is_told_with_the_start_and_beside_the_records() {
    let told = |change: fn(&mut Answer)| {
        let bench = Bench::new();
        let mut camera = FakeCamera::new();
        camera.change = change;
        let port = Port::with_camera(camera);
        let device = fly(&bench, &port);
        let status = bench.run(&["camera", "--device", &device, "status"]).ok();
        let fetched = bench.run(&["records", "--device", &device, "--out", "kept"]);
        // Its lines are broken for a terminal.
        let words: Vec<_> = status.stdout.split_whitespace().collect();
        (words.join(" "), fetched.ok().stderr)
    };
    let (status, beside) = told(|_| {});
    assert!(!status.contains("no record"), "{status}");
    assert_eq!(beside, "");
    let (status, beside) = told(|answer| {
        if let Answer::Status(status) = answer {
            status.after_reset.outcome = FlightAfterReset::FliesOn;
            status.after_reset.without_eyes = WithoutEyes::AtMost {
                before_clock_ms: 566,
                start_up_ms: 21,
            };
        }
    });
    let line = "triggers left no record for at most 587 ms: 566 ms until its clock ran, 21 ms until the first round";
    assert!(status.contains(line), "{status}");
    assert_eq!(beside, format!("note: start 1: {line}\n"));
    let (status, beside) = told(|answer| {
        if let Answer::Status(status) = answer {
            status.after_reset.outcome = FlightAfterReset::FromFlash;
            status.after_reset.without_eyes = WithoutEyes::Unknown;
        }
    });
    let line = "triggers left no record for a time that the camera cannot tell";
    assert!(
        status.contains(line) && beside.contains(line),
        "{status}{beside}"
    );
    // UTC of the last record bounds it.
    assert!(beside.contains("it began after centroid_unix_us 1") && beside.contains("record 4"));
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

#[test]
fn records_fetched_before_their_doubt_are_marked_in_their_files() {
    let bench = Bench::new();
    let mut camera = FakeCamera::new();
    camera.change = |answer| {
        if let Answer::Status(status) = answer {
            status.in_doubt = Some(InDoubt::between([1, 2], 0.0162, true));
        }
    };
    let port = Port::with_camera(camera);
    let device = fly(&bench, &port);
    let records = |folder: &str, earlier: &[&str]| {
        let mut command = vec!["records", "--device", &device, "--out", folder];
        for folder in earlier {
            command.extend(["--earlier", folder]);
        }
        bench.run(&command)
    };
    let before = fs::read_to_string(bench.path("flight/records.csv")).unwrap();
    // A folder of records that the camera still has is none of earlier ones, and nothing is lost.
    fs::create_dir(bench.path("other")).unwrap();
    for name in ["records.csv", "records.json"] {
        let text = fs::read_to_string(bench.path("flight").join(name)).unwrap();
        let later = text
            .replace("\n1,", "\n7,")
            .replace("\"sequence\": 1,", "\"sequence\": 7,");
        fs::write(bench.path("other").join(name), later).unwrap();
    }
    records("kept", &["other"]).refused(&["other/records.csv", "sequence 7", "below 2"]);
    records("kept", &["nowhere"]).refused(&["nowhere/records.csv"]);
    assert!(!bench.path("kept").exists());

    let fetched = records("kept", &["flight"]).ok();
    assert!(
        fetched
            .stdout
            .contains("flight: 1 records in doubt, marked"),
        "{}",
        fetched.stdout
    );
    assert_eq!(fetched.stderr, "");
    let after = fs::read_to_string(bench.path("flight/records.csv")).unwrap();
    assert!(!before.contains("unreferenced") || !before.contains("encoder"));
    let row = after.lines().nth(1).unwrap();
    assert!(
        row.contains("encoder") && row.contains("unreferenced"),
        "{row}"
    );
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(bench.path("flight/records.json")).unwrap()).unwrap();
    let sigma_mm = json["records"][0]["principal_point_sigma_mm"].as_f64();
    assert!(sigma_mm.unwrap() >= 0.0162, "{sigma_mm:?}");

    // Nobody has named the folder.
    let told = records("empty", &[]).ok();
    assert!(
        told.stderr.contains("records 1 to 2") && told.stderr.contains("--earlier"),
        "{}",
        told.stderr
    );
    assert_eq!(
        records("again", &["flight", "kept"]).ok().stdout,
        "no records\n"
    );

    // Records of another calibration are refused, even if the camera has none left to compare with.
    for name in ["records.csv", "records.json"] {
        let text = fs::read_to_string(bench.path("flight").join(name)).unwrap();
        let crc = json["records"][0]["calibration_crc32"].as_str().unwrap();
        fs::write(
            bench.path("other").join(name),
            text.replace(crc, "01234567"),
        )
        .unwrap();
    }
    records("later", &["other"]).refused(&["other/records.csv", "calibration 01234567"]);
}
