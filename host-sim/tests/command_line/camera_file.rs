//! Check of a camera file.

use crate::command_line::mission_grids::grid;
use crate::command_line::support::{Bench, CAMERA};

const CHECK: [&str; 3] = ["camera-file", "check", "camera.toml"];

/// Returns what the answer says of a name, on one line.
fn said(stdout: &str, name: &str) -> String {
    let lines = stdout.lines().skip_while(|line| !line.starts_with(name));
    let mut said = String::new();
    for (index, line) in lines.enumerate() {
        if index > 0 && !line.starts_with(' ') {
            break;
        }
        let words: String = line.chars().skip(25).collect();
        said = format!("{said} {}", words.trim());
    }
    said.trim().to_owned()
}

#[test]
fn check_states_format_corner_and_limits() {
    let answer = Bench::new().run(&CHECK).ok();
    assert_eq!(answer.stderr, "");
    let said = |name| said(&answer.stdout, name);
    assert_eq!(
        said("sensor"),
        "9216 x 9216 px of 8.75 µm, 80.640 x 80.640 mm"
    );
    assert_eq!(
        said("limits of V/H"),
        "0.05 to 0.17 1/s ([limits] of camera.toml)"
    );
    assert_eq!(
        said("limits of exposure"),
        "1/1000 s to 1/50 s ([limits] of camera.toml)"
    );
    assert_eq!(said("longest exposure"), "1/50 s: V/H up to 0.17 1/s");
}

#[test]
fn grids_are_stated_with_nodes_pitch_and_crc_and_a_damaged_one_is_named() {
    let (file, crc) = grid();
    let table = format!("[grid]\nlens = \"lens.fmcg\"\nlens_crc32 = \"{crc:08x}\"\n");
    let bench = Bench::with(&format!("{CAMERA}\n{table}"), b"");
    std::fs::write(bench.path("lens.fmcg"), &file).unwrap();
    let answer = bench.run(&CHECK).ok();
    assert_eq!(
        said(&answer.stdout, "residual grids"),
        format!("lens: 64 x 64 nodes every 2 mm, CRC-32 {crc:08x}")
    );
    std::fs::write(bench.path("lens.fmcg"), &file[..file.len() - 1]).unwrap();
    bench
        .run(&CHECK)
        .failed(2, &["camera.toml", "[grid]", "16415 bytes"]);
    let none = Bench::new().run(&CHECK).ok();
    assert_eq!(said(&none.stdout, "residual grids"), "none");
}

/// K1 alone: 1e-7 · 57.02³ mm.
#[test]
fn corner_has_the_distortion_of_the_coefficients() {
    let camera = "name = \"k1\"\nprincipal_distance_mm = 100\n[sensor]\nwidth_px = 9216\n\
                  height_px = 9216\npixel_um = 8.75\n[distortion]\nk1 = 1e-7\n";
    for sign in ["", "sign = \"correction\"\n"] {
        let answer = Bench::with(&format!("{camera}{sign}"), b"")
            .run(&CHECK)
            .ok();
        let corner = said(&answer.stdout, "distortion at the corner");
        assert!(
            corner.starts_with("18.54 µm, 2.12 px, 0.033 % of the radius of 57.02 mm"),
            "{corner}"
        );
        let limits = said(&answer.stdout, "limits of V/H");
        assert!(limits.contains("default limits"), "{limits}");
    }
}

#[test]
fn exposures_beyond_the_stroke_are_told() {
    let short = CAMERA.replace("stroke_mm = 4.0", "stroke_mm = 0.3");
    let answer = Bench::with(&short, b"").run(&CHECK).ok();
    let longest = said(&answer.stdout, "longest exposure");
    let (_, rest) = longest.split_once("V/H up to ").expect(&longest);
    let largest: f64 = rest.split(' ').next().unwrap().parse().unwrap();
    assert!(largest < 0.17 && rest.contains("stroke"), "{longest}");
    // The limit is the one at which `frame` begins to refuse.
    for (vh_per_s, code) in [(largest - 0.001, 0), (largest + 0.001, 2)] {
        let bench = Bench::with(&short, b"");
        let vh = vh_per_s.to_string();
        let frame = [
            "frame",
            "--camera",
            "camera.toml",
            "--vh",
            &vh,
            "--exposure",
            "1/50",
        ];
        assert_eq!(bench.run(&frame).code, code, "{vh}");
    }
}

#[test]
fn refusals_and_warnings_are_those_of_every_command() {
    for (from, to) in [
        ("k1 = -1.0e-6", "k1 = -1.0"),
        ("stroke_mm = 4.0", "stroke_mm = 400.0"),
        ("[limits]", "[limit]"),
        ("pixel_um = 8.75", ""),
        ("k1 = -1.0e-6", "k1 = 5.0e-5"),
    ] {
        let bench = Bench::with(&CAMERA.replace(from, to), b"");
        let (check, frame) = (bench.run(&CHECK), bench.points("frame", &[]));
        assert_eq!((check.code, &check.stderr), (frame.code, &frame.stderr));
        assert!(!check.stderr.is_empty(), "{to}");
        assert_eq!(check.stdout.is_empty(), check.code == 2, "{to}");
    }
    Bench::new()
        .run(&["camera-file", "check", "nowhere.toml"])
        .refused(&["nowhere.toml"]);
}
