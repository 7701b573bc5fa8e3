//! `camera`: a camera on a board, prepared, armed and watched over a serial port.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::{Action, Event, ShutterEdge};
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::message::ResetCause;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::serial::Port;
use crate::command_line::support::{Answer, Bench, CAMERA};

/// Rounds of the control loop from one message to the next.
const ROUNDS: u64 = 60;

/// A board with an ideal stage and an ideal shutter, whose time advances with the messages it
/// receives.
struct Board {
    bench: Bench,
    port: Port,
    triggers: Arc<AtomicU32>,
}

impl Board {
    fn new() -> Self {
        let drive = RigDrive::new(DriveSettings::default()).unwrap();
        let mut camera =
            FakeCamera::with(FlownDeck::new(drive, ResetCause::PowerOn.unreferenced()));
        let triggers = Arc::new(AtomicU32::new(0));
        let wanted = Arc::clone(&triggers);
        let mut now = Time::START;
        let mut edges: Vec<(Time, Event)> = Vec::new();
        camera.before = Box::new(move |deck| {
            for _ in 0..ROUNDS {
                now = Time::from_us(now.us() + 1000);
                if wanted.swap(0, Ordering::SeqCst) > 0 {
                    deck.capture(now, Event::Trigger);
                }
                for (time, event) in edges.extract_if(.., |(time, _)| *time <= now) {
                    deck.capture(time, event);
                }
                round(deck, now, &mut edges);
            }
        });
        Self {
            bench: Bench::new(),
            port: Port::with_camera(camera),
            triggers,
        }
    }

    fn run(&self, action: &[&str]) -> Answer {
        let device = self.port.device();
        let arguments = [&["camera", "--device", &device], action].concat();
        self.bench.run(&arguments)
    }

    fn says(&self, action: &[&str], line: &str) {
        let answer = self.run(action).ok();
        assert_eq!(answer.stdout, format!("{line}\n"), "{action:?}");
    }

    fn status(&self) -> serde_json::Value {
        let answer = self.run(&["status", "--json"]).ok();
        serde_json::from_str(&answer.stdout).unwrap()
    }
}

fn round(deck: &mut FlownDeck<RigDrive>, now: Time, edges: &mut Vec<(Time, Event)>) {
    let setpoint = deck.controller().and_then(|it| it.setpoint(now));
    if let Some(setpoint) = setpoint {
        let count = format!("{:.0}", setpoint.offset_mm * 1e4).parse().unwrap();
        deck.drive_mut().set_count(count);
    }
    for action in deck.round(now) {
        if let Action::OpenShutter { at, exposure_s } = action {
            let opened = at.plus_s(0.002);
            edges.push((opened, Event::Shutter(ShutterEdge::Opened)));
            let closed = opened.plus_s(exposure_s);
            edges.push((closed, Event::Shutter(ShutterEdge::Closed)));
        }
    }
}

#[test]
fn camera_on_a_board_is_flown_by_commands_and_its_records_are_fetched() {
    let board = Board::new();
    board
        .run(&["status"])
        .failed(3, &["not been prepared", "camera prepare"]);
    board.says(&["prepare", "--camera", "camera.toml"], "standby");
    let status = board.run(&["status"]).ok().stdout;
    let encoder = "encoder          0.0000 mm from its zero";
    assert!(status.lines().all(|line| line.chars().count() <= 80));
    for part in [
        "standby",
        "lost",
        "`host-sim camera referenced`",
        "0 to be fetched",
        encoder,
    ] {
        assert!(status.contains(part), "{status}");
    }
    assert_eq!(board.status()["offset_mm"], 0.0);
    board.says(&["arm"], "degraded: encoder (14)");
    board.says(&["clear-fault"], "standby");
    board.says(&["referenced"], "standby");
    board.says(&["exposure", "1/100"], "standby");
    board.says(&["vh", "0.1"], "standby");
    board.says(&["arm"], "armed");
    board
        .run(&["prepare", "--camera", "camera.toml"])
        .failed(3, &["armed or in flight", "camera disarm"]);

    board.triggers.store(1, Ordering::SeqCst);
    // Two messages later the frame is over and the stage has returned.
    let status = board.status();
    assert_eq!(status["state"], "armed", "{status}");
    assert_eq!(
        (&status["triggers"], &status["exposed"]),
        (&1.into(), &1.into())
    );
    assert_eq!(status["lost_events"], 0);
    assert_eq!(status["findings"]["V/H jump"], 0);
    let text = board.run(&["status"]).ok().stdout;
    assert!(text.contains("found            nothing"), "{text}");
    assert!(!text.contains("found last"), "{text}");
    assert!(text.contains("clock            not measured"), "{text}");
    assert_eq!(board.status()["last_finding"], serde_json::Value::Null);
    // Each finding is counted under its name.
    board.says(&["vh", "1.5"], "armed");
    let text = board.run(&["status"]).ok().stdout;
    assert!(text.contains("found            1 V/H jump\n"), "{text}");
    assert!(text.contains("found last       V/H jump, 0."), "{text}");
    let status = board.status();
    assert_eq!(status["findings"]["V/H jump"], 1);
    assert_eq!(status["last_finding"], "V/H jump");
    let age_s = status["last_finding_age_s"].as_f64().unwrap();
    assert!(age_s > 0.0 && age_s < 1.0, "{age_s}");
    board.says(&["disarm"], "standby");
    board
        .run(&["prepare", "--camera", "camera.toml"])
        .failed(3, &["1 records", "host-sim records"]);
    let device = board.port.device();
    let fetched = board
        .bench
        .run(&["records", "--device", &device, "--out", "kept"])
        .ok();
    assert!(fetched.stdout.contains("1 records"), "{}", fetched.stdout);
    let records = fs::read(board.bench.path("kept/records.json")).unwrap();
    let records: serde_json::Value = serde_json::from_slice(&records).unwrap();
    let record = &records["records"][0];
    let exposure_s = record["exposure_s"].as_f64().unwrap();
    // The stamps have a resolution of 1 µs.
    assert!((exposure_s - 0.01).abs() < 1.1e-6, "{record}");
    board.says(
        &[
            "prepare",
            "--camera",
            "camera.toml",
            "--direction",
            "reverse",
        ],
        "standby",
    );
    assert_eq!(board.status()["triggers"], 0);
}

#[test]
fn flight_goes_on_with_another_calibration_and_each_record_names_its_own() {
    let board = Board::new();
    let newer = format!("serial = \"SN 5282\"\nversion = 4\n{CAMERA}");
    fs::write(board.bench.path("newer.toml"), newer).unwrap();
    let recalibrate = ["recalibrate", "--camera", "newer.toml"];
    board
        .run(&recalibrate)
        .failed(3, &["not been prepared", "camera prepare"]);
    board.says(&["prepare", "--camera", "camera.toml"], "standby");
    board.says(&["clear-fault"], "standby");
    board.says(&["referenced"], "standby");
    board.says(&["vh", "0.1"], "standby");
    board.says(&["arm"], "armed");
    board
        .run(&recalibrate)
        .failed(3, &["armed or in flight", "camera disarm"]);
    board.triggers.store(1, Ordering::SeqCst);
    assert_eq!(board.status()["exposed"], 1);
    board.says(&["disarm"], "standby");
    let before = board.status();
    board.says(&recalibrate, "standby");
    let mut after = board.status();
    assert_eq!(after["calibration"]["version"], 4);
    assert_eq!(
        (&after["triggers"], &after["records_kept"]),
        (&1.into(), &1.into())
    );
    after["calibration"] = before["calibration"].clone();
    assert_eq!(after, before);
    // A mechanism that is another in kind is none for this flight.
    let rows = "[fmc]\naxis = \"+y\"\nmechanism = \"tdi\"\n";
    let tdi = CAMERA.split("[fmc]").next().unwrap().to_owned() + rows;
    fs::write(board.bench.path("tdi.toml"), tdi).unwrap();
    board
        .run(&["recalibrate", "--camera", "tdi.toml"])
        .failed(3, &["another mechanism", "camera prepare"]);
    board.says(&["focus-shift", "-25"], "standby");
    board.says(&["arm"], "armed");
    board.triggers.store(1, Ordering::SeqCst);
    assert_eq!(board.status()["exposed"], 2);
    board.says(&["disarm"], "standby");
    let device = board.port.device();
    let fetch = ["records", "--device", &device, "--out", "kept"];
    assert!(board.bench.run(&fetch).ok().stdout.contains("2 records"));
    let csv = fs::read_to_string(board.bench.path("kept/records.csv")).unwrap();
    let records: Vec<&str> = csv.lines().skip(1).collect();
    let made_with = [",,,volatile,1,1", ",SN 5282,4,volatile,1,1"];
    assert_eq!(records.len(), made_with.len());
    for (record, made_with) in records.iter().zip(made_with) {
        assert!(record.ends_with(made_with), "{csv}");
    }
    let names: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let at = names.iter().position(|name| *name == "focus_shift_mm");
    let shift_mm = |record: usize| -> f32 {
        let mut fields = records[record].split(',');
        fields.nth(at.unwrap()).unwrap().parse().unwrap()
    };
    // The stage of this camera runs out by 1 µm in a millimetre of its way.
    assert!(shift_mm(0).abs() < 1e-3, "{csv}");
    assert!((shift_mm(1) - shift_mm(0) + 0.025).abs() < 1e-4, "{csv}");
}

#[test]
fn temperature_is_told_and_the_focus_of_the_table_is_in_the_record() {
    let board = Board::new();
    let table = "[focus]\ntemperature_c = [-20, 20]\nfocus_shift_um = [-60, 20]\n";
    fs::write(board.bench.path("table.toml"), format!("{CAMERA}{table}")).unwrap();
    board.says(&["prepare", "--camera", "table.toml"], "standby");
    board.says(&["clear-fault"], "standby");
    board.says(&["referenced"], "standby");
    board.says(&["temperature", "-10"], "standby");
    board.says(&["vh", "0.1"], "standby");
    board.says(&["arm"], "armed");
    board.triggers.store(1, Ordering::SeqCst);
    assert_eq!(board.status()["exposed"], 1);
    board.says(&["disarm"], "standby");
    let device = board.port.device();
    let fetch = ["records", "--device", &device, "--out", "kept"];
    board.bench.run(&fetch).ok();
    let records = fs::read(board.bench.path("kept/records.json")).unwrap();
    let records: serde_json::Value = serde_json::from_slice(&records).unwrap();
    let shift_mm = records["records"][0]["focus_shift_mm"].as_f64().unwrap();
    // The stage of this camera runs out by 1 µm in a millimetre of its way.
    assert!((shift_mm + 0.040).abs() < 1e-3, "{records}");
}

#[test]
fn identity_of_the_calibration_is_in_the_status_and_in_the_records() {
    let board = Board::new();
    let camera = format!("serial = \"SN 5282\"\nversion = 3\n{CAMERA}");
    fs::write(board.bench.path("numbered.toml"), camera).unwrap();
    board.says(&["prepare", "--camera", "camera.toml"], "standby");
    let plain = board.status()["calibration"].clone();
    assert_eq!(plain["serial"], serde_json::Value::Null);
    assert_eq!(plain["version"], serde_json::Value::Null);
    assert_eq!(plain["storage"], "volatile");
    board.says(&["prepare", "--camera", "numbered.toml"], "standby");
    let numbered = board.status()["calibration"].clone();
    assert_eq!(numbered["serial"], "SN 5282");
    assert_eq!(numbered["version"], 3);
    let crc = numbered["crc32"].as_str().unwrap();
    assert_ne!(crc, plain["crc32"], "it covers both");
    let line = format!("calibration      serial SN 5282, version 3, CRC-32 {crc}, volatile\n");
    let text = board.run(&["status"]).ok().stdout;
    assert!(text.contains(&line), "{text}");

    // A trigger in standby is refused, and recorded.
    board.triggers.store(1, Ordering::SeqCst);
    board.says(&["vh", "0.1"], "standby");
    let device = board.port.device();
    board
        .bench
        .run(&["records", "--device", &device, "--out", "kept"])
        .ok();
    let csv = fs::read_to_string(board.bench.path("kept/records.csv")).unwrap();
    let mut lines = csv.lines();
    let names = ",calibration_serial,calibration_version,calibration_storage,boot,flight";
    assert!(lines.next().unwrap().ends_with(names), "{csv}");
    let record = lines.next().unwrap();
    let crc = format!(",{crc},");
    assert!(
        record.contains(&crc) && record.ends_with(",SN 5282,3,volatile,1,2"),
        "{csv}"
    );
}

#[test]
fn reference_out_of_standby_is_not_taken_silently() {
    let board = Board::new();
    board.says(&["prepare", "--camera", "camera.toml"], "standby");
    board.says(&["arm"], "degraded: encoder (14)");
    board
        .run(&["referenced"])
        .failed(3, &["still in state degraded", "standby alone"]);
}

#[test]
fn settings_are_checked_here_and_named() {
    let board = Board::new();
    fs::write(
        board.bench.path("flight.toml"),
        "smear_budget_px = 1000.0\n",
    )
    .unwrap();
    fs::write(board.bench.path("slow.toml"), "exposure_s = 0.5\n").unwrap();
    let prepare = ["prepare", "--camera", "camera.toml", "--settings"];
    board
        .run(&[&prepare[..], &["flight.toml"]].concat())
        .refused(&["flight.toml", "smear_budget_px = 1000", "0.01 to 100"]);
    board
        .run(&[&prepare[..], &["slow.toml"]].concat())
        .refused(&["camera.toml", "0.5", "0.001"]);
    board
        .run(&[&prepare[..], &["nowhere.toml"]].concat())
        .refused(&["nowhere.toml"]);
    fs::write(
        board.bench.path("flight.toml"),
        "exposure_s = 0.005\n[drive]\nencoder_step_um = 0.2\n",
    )
    .unwrap();
    board.says(&[&prepare[..], &["flight.toml"]].concat(), "standby");
}

#[test]
fn bad_input_is_refused_before_a_port_is_opened() {
    let bench = Bench::new();
    let run = |arguments: &[&str]| {
        bench.run(&[&["camera", "--device", "serial:nowhere"], arguments].concat())
    };
    run(&["exposure", "20"]).refused(&["exposure_s = 20", "0.000001 to 10"]);
    run(&["exposure", "-1"]).refused(&["positive time"]);
    run(&["temperature", "101"]).refused(&["101", "-100 to 100"]);
    run(&["temperature", "nan"]).refused(&["nan"]);
    run(&["temperature"]).refused(&["<C>"]);
    run(&["vh", "5"]).refused(&["vh = 5", "0.001 to 2"]);
    run(&["vh", "0.1", "--for", "-2"]).refused(&["--for"]);
    run(&["prepare"]).refused(&["--camera"]);
    run(&["prepare", "--camera", "none.toml"]).refused(&["none.toml"]);
    run(&["fly"]).refused(&["fly"]);
    run(&["arm"]).failed(3, &["nowhere: there is no such port"]);
    for device in [
        &["camera", "arm"][..],
        &["camera", "--device", "sil", "arm"],
        &["camera", "--device", "qemu", "status"],
    ] {
        bench
            .run(device)
            .refused(&["--device serial:PATH", "host-sim mission"]);
    }
}

#[test]
fn camera_on_a_test_rig_says_what_to_use_instead() {
    let bench = Bench::new();
    let port = Port::with_camera(FakeCamera::new());
    let device = port.device();
    bench
        .run(&["camera", "--device", &device, "arm"])
        .failed(3, &[&device, "test rig", "host-sim mission"]);
}
