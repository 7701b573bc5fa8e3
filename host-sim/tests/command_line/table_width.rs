//! Width of the tables of every command.

#[cfg(unix)]
use std::process::Command;

use crate::command_line::observations::{EXPOSURES, csv, rows};
use crate::command_line::support::{Answer, Bench, CAMERA, EXPOSURE};
#[cfg(unix)]
use crate::command_line::terminal::Terminal;

const WIDTH: usize = 80;

/// Checks that an answer holds so many tables, and that none is too wide.
fn assert_narrow(answer: &Answer, tables: usize) {
    let found = answer.tables();
    assert_eq!(found.len(), tables, "{}", answer.stdout);
    for line in found.iter().flatten() {
        assert!(line.chars().count() <= WIDTH, "{line}");
    }
}

#[test]
fn tables_fit_80_columns_whatever_the_camera() {
    let bench = Bench::new();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/cameras/");
    assert_narrow(&bench.run(&["verify", "--device", "sil"]).ok(), 2);
    for name in ["rc30-5324.toml", "phase-one-ixm-rs150f-50.toml"] {
        let file = format!("{folder}{name}");
        let exposure = ["--camera", &file, "--vh", "0.1", "--exposure", "1/200"];
        assert_narrow(&bench.run(&["budget", "--camera", &file]).ok(), 1);
        let sweep = ["sweep", "--camera", &file, "--out", "sweep"];
        assert_narrow(&bench.run(&sweep).ok(), 1);
        assert_narrow(&bench.run(&[&["smear"], &exposure[..]].concat()).ok(), 1);
        let tilted = ["--pitch-deg", "-12.3456", "--roll-rate-deg-s", "59.1234"];
        let tilted = [&["smear"], &exposure[..], &tilted].concat();
        assert_narrow(&bench.run(&tilted).ok(), 1);
        for arguments in [
            &[&["frame"], &exposure[..]].concat()[..],
            &["camera-file", "check", &file],
            &["export", "opencv", "--camera", &file, "--out", "opencv"],
        ] {
            for line in bench.run(arguments).ok().stdout.lines() {
                // A name of a file is not broken.
                let is_path = line.contains(&file);
                assert!(is_path || line.chars().count() <= WIDTH, "{line}");
            }
        }
    }
}

#[test]
fn tables_of_both_strips_fit_80_columns() {
    let bench = Bench::new();
    for name in ["strip.toml", "yuan-2012.toml"] {
        let scenario = format!("{}/scenarios/{name}", env!("CARGO_MANIFEST_DIR"));
        let strip = ["strip", "--scenario", &scenario, "--repetitions", "2"];
        let answer = bench.run(&[&strip[..], &["--out", "strip"]].concat());
        assert_narrow(&answer.ok(), 1);
    }
}

#[test]
fn tables_of_a_calibration_fit_80_columns() {
    let bench = Bench::new();
    std::fs::write(bench.path("obs.csv"), csv(&rows(&EXPOSURES, 9))).unwrap();
    for how in ["hold", "estimate"] {
        let answer = bench.run(&[
            "calibrate",
            "five",
            "obs.csv",
            "--camera",
            "camera.toml",
            "--static-p2",
            how,
        ]);
        let answer = answer.ok();
        assert_narrow(&answer, 2);
        for line in answer.stdout.lines() {
            assert!(line.chars().count() <= WIDTH, "{line}");
        }
    }
}

/// Returns the lines that a command writes on a terminal of so many columns.
#[cfg(unix)]
fn lines_on_a_terminal(bench: &Bench, columns: u16, arguments: &[&str]) -> Vec<String> {
    let mut command = bench.command(arguments);
    command.stderr(std::process::Stdio::null());
    let (shown, code) = Terminal::open().shows(columns, command, Command::stdout);
    assert_eq!(code, Some(0), "{shown}");
    shown.lines().map(str::to_owned).collect()
}

#[cfg(unix)]
#[test]
fn tables_are_as_wide_as_the_terminal_from_80_to_120_columns() {
    let name = "a camera whose name is far longer than the column of a table leaves room for it, \
                so that it goes on in further lines until the terminal is wide";
    let camera = CAMERA.replace("Test camera", name);
    let bench = Bench::with(&camera, b"");
    let camera = ["--camera", "camera.toml"];
    let frame = [&["frame"], &EXPOSURE[..]].concat();
    let export = [
        "export",
        "metashape",
        "--camera",
        "camera.toml",
        "--out",
        "x",
    ];
    let verify = [&["verify", "--device", "sil"], &camera[..]].concat();
    for arguments in [&frame[..], &export, &verify] {
        let mut before = usize::MAX;
        for (columns, widest) in [(60, 80), (80, 80), (100, 100), (120, 120), (200, 120)] {
            let lines = lines_on_a_terminal(&bench, columns, arguments);
            // The lines of a table's frame are as long as the table; pairs have none.
            let rules = lines.iter().filter(|line| line.starts_with(['─', '═']));
            let counted: Vec<&String> = rules.collect();
            let counted = if counted.is_empty() {
                lines.iter().collect()
            } else {
                counted
            };
            let width = counted
                .iter()
                .map(|line| line.chars().count())
                .max()
                .unwrap();
            let what = format!("{}, {columns} columns: {lines:#?}", arguments[0]);
            assert!(width <= widest && width > widest - 20, "{width}, {what}");
            assert!(lines.len() <= before, "{what}");
            before = lines.len();
        }
    }
}
