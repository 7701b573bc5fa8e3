//! Width of the tables of every command.

use crate::command_line::observations::{EXPOSURES, csv, rows};
use crate::command_line::support::{Answer, Bench};

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
