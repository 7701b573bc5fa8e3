//! QEMU missing, broken and dying.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

use assert_cmd::cargo::cargo_bin;
use fmc_camera::SensorPoint;
use fmc_camera::flight::camera::FrameError;
use fmc_camera::geometry::calibration::{CalibrationError, Polynomial};
use fmc_camera::io::link::PROTOCOL_VERSION;
use fmc_camera::io::link::message::{Answer, Refusal};
use rustix::process::{Pid, Signal, kill_process, kill_process_group};

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::fake_qemu::{FakeQemu, PATIENCE, SCRIPT, ends, wait_for};
use crate::command_line::support::{Answer as Output, Bench};
use crate::command_line::wire_format::frame_of;

const CORRECT: [&str; 10] = [
    "correct",
    "--camera",
    "camera.toml",
    "--vh",
    "0.1",
    "--exposure",
    "1/200",
    "--device",
    "qemu",
    "points.csv",
];

const VERIFY: [&str; 5] = ["verify", "--camera", "camera.toml", "--device", "qemu"];

#[test]
fn qemu_that_is_missing_is_an_error_where_it_was_asked_for_and_a_note_where_not() {
    let bench = Bench::new();
    let program = in_a_target_directory(&bench);
    let run = |arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(arguments).current_dir(bench.folder());
        Output::new(&command.env("PATH", bench.folder()).output().unwrap())
    };
    for arguments in [&CORRECT[..], &VERIFY] {
        run(arguments).failed(
            3,
            &["qemu-system-arm is not on the search path", "--device sil"],
        );
    }
    let answer = run(&["verify", "--camera", "camera.toml"]).ok();
    let lines: Vec<_> = answer.stdout.lines().collect();
    let (first, last) = (lines[0], lines[lines.len() - 1]);
    assert!(first.starts_with("device: sil"), "{first}");
    assert!(last.starts_with("ran on sil"), "{last}");
    for line in [first, last] {
        for part in [
            "NOT in QEMU: qemu-system-arm is not on the search path",
            "to mend it: cargo xtask verify",
        ] {
            assert!(line.contains(part), "{line}");
        }
    }
    // An image that the user names must be run, so there is no fallback.
    run(&["verify", "--firmware", "firmware.elf"]).failed(3, &["qemu-system-arm"]);
}

#[test]
fn reason_of_the_workspace_is_the_first_line_and_the_last() {
    let bench = Bench::new();
    let reason = "no QEMU: no network; to mend it: sudo apt-get install qemu-system-arm";
    let arguments = ["verify", "--camera", "camera.toml", "--not-in-qemu", reason];
    let answer = bench
        .run(&[&arguments[..], &["--out", "out"]].concat())
        .ok();
    let lines: Vec<_> = answer.stdout.lines().collect();
    for line in [lines[0], lines[lines.len() - 1]] {
        assert!(line.ends_with(&format!("NOT in QEMU: {reason}")), "{line}");
    }
    for file in ["summary.json", "report.html"] {
        let text = fs::read_to_string(bench.path("out").join(file)).unwrap();
        assert_eq!(text.matches(reason).count(), 2, "{file}");
    }
    bench
        .run(&[&arguments[..], &["--device", "sil"]].concat())
        .refused(&["--not-in-qemu", "--device"]);
}

#[test]
fn qemu_that_the_workspace_has_fetched_is_found_behind_the_search_path() {
    let bench = Bench::new();
    let program = in_a_target_directory(&bench);
    let fetched = bench.path("target/tools/qemu/bin/qemu-system-arm");
    fs::create_dir_all(fetched.parent().unwrap()).unwrap();
    fs::write(
        &fetched,
        "#!/bin/sh\necho 'this is the fetched one' >&2\nexit 7\n",
    )
    .unwrap();
    fs::set_permissions(&fetched, fs::Permissions::from_mode(0o755)).unwrap();
    let qemu = FakeQemu::new("#!/bin/sh\necho 'this is on the search path' >&2\nexit 7\n");
    for (path, says) in [
        (bench.folder().to_owned(), "this is the fetched one"),
        (qemu.path(""), "this is on the search path"),
    ] {
        let mut command = Command::new(&program);
        command
            .args(VERIFY)
            .current_dir(bench.folder())
            .env("PATH", path)
            .env("FMC_FIRMWARE", qemu.bench.path("firmware.elf"));
        Output::new(&command.output().unwrap()).failed(3, &[says]);
    }
}

/// Copies the program to a target directory in which nothing has been fetched.
fn in_a_target_directory(bench: &Bench) -> PathBuf {
    let directory = bench.path("target/debug");
    fs::create_dir_all(&directory).unwrap();
    fs::write(bench.path("target/CACHEDIR.TAG"), "").unwrap();
    let program = directory.join("host-sim");
    fs::copy(cargo_bin!("host-sim"), &program).unwrap();
    program
}

#[test]
fn image_that_is_missing_or_none_is_bad_input() {
    let qemu = FakeQemu::new(SCRIPT);
    for (image, why) in [
        ("nowhere.elf", "cannot be read"),
        ("camera.toml", "not an ELF file for 32-bit ARM"),
        ("bin", "cannot be read"),
    ] {
        let arguments = [&VERIFY[..], &["--firmware", image]].concat();
        qemu.run(&arguments).refused(&[image, why]);
        let mut command = qemu.command(&["verify"]);
        Output::new(&command.env("FMC_FIRMWARE", image).output().unwrap()).refused(&[image, why]);
    }
    assert!(!qemu.path("started").exists());
}

#[test]
fn options_for_qemu_are_refused_elsewhere() {
    let bench = Bench::new();
    bench
        .points("correct", &["--log"])
        .refused(&["--log", "--device qemu"]);
    bench
        .run(&["verify", "--device", "sil", "--firmware", "x"])
        .refused(&["--firmware", "--device qemu"]);
}

#[test]
fn qemu_that_ends_at_once_is_reported_with_status_and_what_it_said() {
    let qemu = FakeQemu::new("#!/bin/sh\necho 'could not load kernel' >&2\nexit 5\n");
    for arguments in [&CORRECT[..], &VERIFY, &["verify"]] {
        qemu.run(arguments).failed(
            3,
            &["ended at once", "exit status: 5", "could not load kernel"],
        );
    }
}

#[test]
fn qemu_that_ends_half_way_is_reported_with_status_and_what_it_said() {
    for answers_given in [0, 1, 3, 20] {
        let qemu = FakeQemu::new(SCRIPT);
        let mut camera = FakeCamera::new();
        camera.goes_on = Box::new(move |answers| answers < answers_given);
        qemu.serve_with(move |mut link| {
            camera.serve(&mut link);
            let _ = link.shutdown(std::net::Shutdown::Both);
        });
        qemu.run(&VERIFY).failed(
            3,
            &["ended half way", "exit status: 7", "fake: triple fault"],
        );
    }
}

#[test]
fn camera_in_qemu_is_started_as_documented_asked_and_switched_off() {
    let qemu = FakeQemu::new(SCRIPT);
    qemu.serve(FakeCamera::new());
    let arguments = CORRECT.map(|word| if word == "qemu" { "qemu:an500" } else { word });
    let there = qemu.run(&arguments).ok();
    let here = qemu.bench.points("correct", &[]).ok();
    assert_eq!(there.stdout, here.stdout);
    let arguments = wait_for(&qemu.path("started"));
    for part in [
        "-M mps2-an500",
        "-icount shift=0",
        "-display none",
        "-kernel firmware.elf",
    ] {
        assert!(arguments.contains(part), "{arguments}");
    }
    assert!(ends(&arguments), "QEMU runs on");
}

#[test]
fn camera_that_stops_answering_is_reported_and_ended() {
    let qemu = FakeQemu::new(SCRIPT);
    let mut camera = FakeCamera::new();
    camera.goes_on = Box::new(move |answers| {
        if answers == 3 {
            loop {
                thread::park();
            }
        }
        true
    });
    qemu.serve(camera);
    qemu.run(&VERIFY).failed(3, &["no answer to", "5 tries"]);
    assert!(ends(&wait_for(&qemu.path("started"))), "QEMU runs on");
}

#[test]
fn image_of_another_protocol_is_named_with_both_versions() {
    let qemu = FakeQemu::new(SCRIPT);
    qemu.serve_with(|mut link| {
        use std::io::{Read, Write};
        link.read_exact(&mut [0; 8]).unwrap();
        link.write_all(&frame_of(&[1, 0, 0, 9])).unwrap();
        let _ = link.read_to_end(&mut Vec::new());
    });
    let versions = format!("version 1 of the protocol, this program version {PROTOCOL_VERSION}");
    qemu.run(&VERIFY)
        .failed(3, &[&versions, "cargo xtask firmware"]);
}

#[test]
fn camera_that_computes_otherwise_fails_the_verification_and_the_report_says_where() {
    let qemu = FakeQemu::new(SCRIPT);
    let mut camera = FakeCamera::new();
    camera.change = |answer| {
        if let Answer::Points(points) = answer
            && let Some(point) = points.get_mut(7)
        {
            point.point.x_mm = point.point.x_mm.next_up();
        }
    };
    qemu.serve(camera);
    let answer = qemu.run(&[&VERIFY[..], &["--out", "report"]].concat());
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    for part in ["FAIL", "Test camera: ", "point 7 at x", "V/H 0.05 1/s"] {
        assert!(answer.stdout.contains(part), "{part}: {}", answer.stdout);
    }
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(qemu.bench.path("report/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["passed"], false);
    assert!(summary["difference"].as_str().unwrap().contains("point 7"));
    let page = fs::read_to_string(qemu.bench.path("report/report.html")).unwrap();
    assert!(page.contains("verdict failed") && page.contains("point 7 at x"));
}

#[test]
fn camera_that_refuses_what_this_pc_accepts_is_not_believed() {
    let load: fn(&mut Answer) = |answer| {
        if matches!(answer, Answer::Loaded(_)) {
            *answer = Answer::Refused(Refusal::Calibration(CalibrationError::Folds {
                polynomial: Polynomial::Static,
                scale: 0.0,
                at: SensorPoint::new(1.0, 2.0),
            }));
        }
    };
    let expose: fn(&mut Answer) = |answer| {
        if matches!(answer, Answer::InteriorOrientation(_)) {
            *answer = Answer::Refused(Refusal::Exposure(FrameError::NotFitted));
        }
    };
    for (change, arguments, code) in [(load, &VERIFY[..], 1), (expose, &CORRECT, 3)] {
        let qemu = FakeQemu::new(SCRIPT);
        let mut camera = FakeCamera::new();
        camera.change = change;
        qemu.serve(camera);
        let answer = qemu.run(arguments);
        assert_eq!(answer.code, code, "{}{}", answer.stdout, answer.stderr);
        let text = answer.stdout + &answer.stderr;
        assert!(
            text.contains("the camera refuses") && text.contains("this PC accepts"),
            "{text}"
        );
    }
}

#[test]
fn qemu_ends_with_a_host_that_is_killed_or_interrupted() {
    for signal in [Signal::KILL, Signal::INT] {
        if signal == Signal::KILL && !Path::new("/usr/bin/setpriv").is_file() {
            continue;
        }
        let qemu = FakeQemu::new(SCRIPT);
        let (link_up, link_is_up) = std::sync::mpsc::channel();
        qemu.serve_with(move |link| {
            link_up.send(()).unwrap();
            let mut buffer = Vec::new();
            let _ = std::io::Read::read_to_end(&mut &link, &mut buffer);
        });
        let mut host = qemu
            .command(&VERIFY)
            .process_group(0)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        link_is_up.recv_timeout(PATIENCE).unwrap();
        let arguments = wait_for(&qemu.path("started"));
        // A terminal interrupts the whole group; a kill ends only the one process.
        let process = Pid::from_child(&host);
        let sent = match signal {
            Signal::INT => kill_process_group(process, signal),
            _ => kill_process(process, signal),
        };
        sent.unwrap();
        assert!(!host.wait().unwrap().success());
        assert!(ends(&arguments), "{signal:?}: QEMU runs on");
    }
}
