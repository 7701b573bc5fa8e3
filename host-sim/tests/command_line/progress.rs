//! The progress bar of a stream of points.

use std::fmt::Write as _;
use std::fs;
use std::process::{Command, Stdio};

use crate::command_line::support::{Bench, CAMERA, EXPOSURE};
use crate::command_line::terminal::Terminal;

fn bench() -> Bench {
    let mut points = String::from("id,x_mm,y_mm\n");
    for row in 0..60_000_u32 {
        writeln!(points, "p{row},{}.5,1.25", row % 40).unwrap();
    }
    let bench = Bench::with(CAMERA, points.as_bytes());
    let row = [1.5_f32, 1.25].map(f32::to_le_bytes).concat();
    // Header of version 1, padded to 128 bytes.
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (60000, 2), }";
    let mut array = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    array.extend(format!("{header:117}\n").bytes());
    array.extend(row.repeat(60_000));
    fs::write(bench.path("points.npy"), array).unwrap();
    bench
}

/// Returns what `correct` shows on a terminal of so many columns; its answers are written
/// elsewhere.
fn shown(bench: &Bench, columns: u16, points: &[&str], stdin: Option<&str>) -> String {
    let arguments = [&["correct"], &EXPOSURE[..], points].concat();
    shown_by(bench, columns, &arguments, stdin)
}

/// Returns what a command shows on such a terminal.
fn shown_by(bench: &Bench, columns: u16, arguments: &[&str], stdin: Option<&str>) -> String {
    let mut command = bench.command(arguments);
    if let Some(stdin) = stdin {
        let file = fs::File::open(bench.path(stdin)).unwrap();
        command.stdin(Stdio::from(file));
    }
    command.stdout(Stdio::null());
    let (shown, code) = Terminal::open().shows(columns, command, Command::stderr);
    // 1 is the outcome of a check, which two missions of `statistics` are too few to pass.
    assert!(matches!(code, Some(0 | 1)), "{code:?}: {arguments:?}");
    shown
}

/// Checks that what is shown needs one line, which would need cursor movements if it were longer.
fn assert_one_line(shown: &str, what: &str) {
    for motion in ["\x1b[1A", "\x1b[1B", "\x1b[2A"] {
        assert!(!shown.contains(motion), "{what}: {shown:?}");
    }
}

#[test]
fn bars_of_simulations_stay_in_their_line() {
    let strip = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/strip.toml");
    let bench = Bench::new();
    let mesh = ["--format", "opencv", "--spacing", "64", "--out", "mesh"];
    for columns in [80, 60, 45] {
        for arguments in [
            &["sweep", "--camera", "camera.toml", "--out", "out"][..],
            &[
                "strip",
                "--scenario",
                strip,
                "--repetitions",
                "4",
                "--out",
                "out",
            ],
            &["statistics", "--missions", "2"],
            &["verify", "--device", "sil", "--camera", "camera.toml"],
            &[&["mesh"], &EXPOSURE[..], &mesh].concat(),
        ] {
            let shown = shown_by(&bench, columns, arguments, None);
            let name = arguments[0];
            assert!(
                shown.contains('█') || shown.contains('░'),
                "{name}: {shown:?}"
            );
            assert_one_line(&shown, &format!("{name}, {columns} columns"));
        }
    }
}

#[test]
fn bar_stays_in_its_line_however_narrow_the_terminal() {
    let bench = bench();
    for columns in [80, 60, 45] {
        for (points, stdin) in [
            (&["points.csv"][..], None),
            (&["points.npy"], None),
            (&["-"], Some("points.csv")),
            (&["--format", "npy", "-"], Some("points.npy")),
        ] {
            let shown = shown(&bench, columns, points, stdin);
            assert!(shown.contains("KiB"), "{shown:?}");
            // A second line would need cursor movements up or down.
            let up_or_down = ["\x1b[1A", "\x1b[1B", "\n"];
            let left = up_or_down.iter().any(|motion| shown.contains(motion));
            assert!(!left, "{columns} columns, {points:?}: {shown:?}");
            assert!(shown.ends_with("\r\x1b[2K"), "nothing stays: {shown:?}");
        }
    }
}

#[test]
fn reading_of_frames_has_a_bar_unless_they_are_listed_on_a_terminal() {
    let bench = Bench::new();
    let mut frames = String::from("sequence,vh,exposure\n");
    for sequence in 1..=30_000_u32 {
        writeln!(frames, "{sequence},0.1,0.00{}", 2 + sequence % 8).unwrap();
    }
    fs::write(bench.path("frames.csv"), frames).unwrap();
    let arguments = ["frame", "--camera", "camera.toml", "--frames", "frames.csv"];
    let with_out = [&arguments[..], &["--out", "list.csv"]].concat();
    for columns in [80, 45] {
        let shown = shown_by(&bench, columns, &with_out, None);
        assert!(shown.contains("KiB"), "{shown:?}");
        assert_one_line(&shown, "frames");
        assert!(shown.ends_with("\r\x1b[2K"), "nothing stays: {shown:?}");
    }
    let quiet = bench.run(&with_out).ok();
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
}

#[test]
fn end_of_an_array_is_known_in_a_pipe_too() {
    let shown = shown(&bench(), 80, &["--format", "npy", "-"], Some("points.npy"));
    assert!(
        shown.contains("/468.75 KiB"),
        "60 000 rows of 8 bytes: {shown:?}"
    );
}

#[test]
fn nothing_of_the_bar_is_shown_where_no_terminal_is() {
    let bench = bench();
    let output = bench
        .command(
            &[
                &["correct"],
                &EXPOSURE[..],
                &["points.csv", "--out", "out.csv"],
            ]
            .concat(),
        )
        .env("TERM", "xterm")
        .output()
        .unwrap();
    assert!(output.status.success());
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}
