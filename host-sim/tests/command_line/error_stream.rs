//! Commands whose notes and errors cannot be written, and notes on what was written.

use std::fs::OpenOptions;
use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;

use crate::command_line::support::{Bench, CAMERA, EXPOSURE, POINTS};

/// Commands that write to the error stream, with their exit codes.
fn commands() -> Vec<(Vec<&'static str>, i32)> {
    let of =
        |command: &[&'static str], more: &[&'static str]| [command, &EXPOSURE[..], more].concat();
    vec![
        (of(&["correct"], &["points.csv"]), 0),
        (
            of(&["reference"], &["--reading", "literal", "points.csv"]),
            0,
        ),
        (
            of(
                &["mesh"],
                &["--format", "gpu", "--spacing", "512", "--out", "mesh"],
            ),
            0,
        ),
        (of(&["smear"], &["--out", "smear"]), 0),
        (of(&["frame"], &["--vh-error"]), 2),
        (
            vec!["budget", "--camera", "camera.toml", "--out", "budget"],
            0,
        ),
        (vec!["camera-file", "check", "camera.toml"], 0),
        (vec!["camera-file", "check", "nowhere.toml"], 2),
        (vec!["mission", "--exposures", "2", "--out", "mission"], 0),
    ]
}

/// Returns a folder with a camera about which every command has a note or a warning.
fn bench() -> Bench {
    let tdi = CAMERA
        .replace("mechanism = \"stage\"", "mechanism = \"tdi\"")
        .replace("k1 = -1.0e-6", "k1 = 5.0e-5");
    Bench::with(&tdi, POINTS.as_bytes())
}

#[test]
fn full_error_stream_changes_no_outcome() {
    for (arguments, code) in commands() {
        let bench = bench();
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut command = bench.command(&arguments);
        let status = command.stdout(Stdio::null()).stderr(full).status().unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}");
        assert!(!bench.run(&arguments).stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn closed_error_stream_changes_no_outcome() {
    for (arguments, code) in commands() {
        let bench = bench();
        let mut shell = Command::new("sh");
        let shell = shell.args(["-c", "exec \"$@\" 2>&-", "sh"]);
        let program = shell.arg(cargo_bin!("host-sim")).args(&arguments);
        let status = program
            .current_dir(bench.folder())
            .stdout(Stdio::null())
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn mesh_names_the_files_that_it_wrote() {
    for (format, files) in [
        ("gpu", "mesh: mesh.bin, mesh.json\n"),
        ("opencv", "mesh: map-x.bin, map-y.bin, mesh.json\n"),
    ] {
        let more = ["--format", format, "--spacing", "512", "--out", "mesh"];
        let bench = Bench::new();
        let answer = bench.run(&[&["mesh"], &EXPOSURE[..], &more].concat()).ok();
        assert_eq!(answer.stderr, files);
    }
}
