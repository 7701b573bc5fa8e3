//! Commands with a camera that has residual grids of lens and sensor.

use std::fmt::Write as _;
use std::fs;

use fmc_camera::geometry::grid::GridCarrier;
use serde_json::Value;

use crate::command_line::support::{Answer, Bench};
use crate::command_line::wave_grid::{Lattice, WaveGrids, wave_grid};

/// 12 x 8.8 mm; the stage moves by many pixels and leaves its plane.
const CAMERA: &str = r#"name = "Small camera"
principal_distance_mm = 20.0
principal_point_mm = [0.02, -0.01]
[sensor]
width_px = 600
height_px = 440
pixel_um = 20.0
[distortion]
k1 = -1.0e-4
p1 = 2.0e-5
[fmc]
axis = "+y"
stroke_mm = 4.0
flatness_um = [0.0, 5.0]
"#;

const EXPOSURE: [&str; 8] = [
    "--camera",
    "camera.toml",
    "--vh",
    "0.17",
    "--exposure",
    "1/100",
    "--opening-offset-mm",
    "0.3",
];

/// Covers the sensor and the stroke.
const LATTICE: Lattice = Lattice {
    nodes: 24,
    pitch_mm: 1.0,
};

/// A folder with the camera and its grids, and with `plain.toml`, the same camera without.
fn bench(amplitude_um: f64) -> Bench {
    let grids = WaveGrids::new(amplitude_um, LATTICE);
    let bench = Bench::with(&format!("{CAMERA}{}", grids.table), b"");
    for (name, bytes) in grids.files() {
        fs::write(bench.path(name), bytes).unwrap();
    }
    fs::write(bench.path("plain.toml"), CAMERA).unwrap();
    bench
}

fn json(bench: &Bench, file: &str) -> Value {
    serde_json::from_slice(&fs::read(bench.path(file)).unwrap()).unwrap()
}

/// Cells of the last columns of an answer, from `dx_um` on or those two before it.
fn answers(answer: Answer, columns: [&str; 4]) -> Vec<[String; 4]> {
    let stdout = answer.ok().stdout;
    let mut table = csv::Reader::from_reader(stdout.as_bytes());
    let header = table.headers().unwrap().clone();
    let places = columns.map(|name| header.iter().position(|one| one == name).unwrap());
    let rows = table.records();
    rows.map(|row| {
        let row = row.unwrap();
        places.map(|place| row[place].to_owned())
    })
    .collect()
}

/// Frames of a table have the bits of single exposures, few points in a frame as many.
#[test]
fn frames_of_a_table_have_the_answers_and_meshes_of_single_exposures() {
    let bench = bench(20.0);
    let mut exposures = String::from("frame,vh,exposure,opening_offset_mm,model\n");
    let kinds = [
        ("0.17", "1/100", "0.3", "exact"),
        ("0.1", "1/200", "-0.4", "exact"),
        ("0.17", "1/100", "0.3", "static"),
    ];
    for (number, (vh, exposure, offset, model)) in (1..).zip(kinds) {
        writeln!(exposures, "{number},{vh},{exposure},{offset},{model}").unwrap();
    }
    fs::write(bench.path("frames.csv"), exposures).unwrap();
    let columns = ["x_mm", "y_mm", "dx_um", "dy_um"];
    for direction in ["correct", "distort"] {
        let mut all = String::from("frame,id,x_mm,y_mm\n");
        let mut single = String::from("id,x_mm,y_mm\n");
        for number in 0..60 {
            let [x, y] = [number % 10, number / 10].map(f64::from);
            let [x, y] = [1.1 * (x - 4.5), 1.4 * (y - 2.5)];
            writeln!(single, "{number},{x},{y}").unwrap();
        }
        for frame in 1..=3 {
            for line in single.lines().skip(1) {
                writeln!(all, "{frame},{line}").unwrap();
            }
        }
        fs::write(bench.path("all.csv"), all).unwrap();
        fs::write(bench.path("points.csv"), single).unwrap();
        let table = [
            direction,
            "--camera",
            "camera.toml",
            "--frames",
            "frames.csv",
            "all.csv",
        ];
        let found = answers(bench.run(&table), columns);
        assert_eq!(found.len(), 180);
        for (found, (vh, exposure, offset, model)) in found.chunks(60).zip(kinds) {
            let one = [
                direction,
                "--vh",
                vh,
                "--exposure",
                exposure,
                "--opening-offset-mm",
                offset,
                "--model",
                model,
                "points.csv",
                "--camera",
            ];
            let expected = answers(bench.run(&[&one[..], &["camera.toml"]].concat()), columns);
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(found[2..], expected[2..], "{direction} {model}");
            }
            let plain = answers(bench.run(&[&one[..], &["plain.toml"]].concat()), columns);
            assert_ne!(found[7][2..], plain[7][2..]);
        }
    }
    let mesh = ["--spacing", "16", "--format", "opencv", "--out"];
    let table = ["mesh", "--camera", "camera.toml", "--frames", "frames.csv"];
    let answer = bench.run(&[&table[..], &mesh, &["all"]].concat());
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    bench
        .run(&[&["mesh"], &EXPOSURE[..], &mesh, &["one"]].concat())
        .ok();
    let mut compared = 0;
    for entry in fs::read_dir(bench.path("one")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name != "mesh.json" {
            let [one, all] = [format!("one/{name}"), format!("all/00001/{name}")]
                .map(|file| fs::read(bench.path(&file)).unwrap());
            assert!(one == all, "{name}");
            compared += 1;
        }
    }
    assert!(compared > 0);
}

/// The answer is that of the strict solver with splines; a pixel of structure is missing without
/// the grids.
#[test]
fn frame_is_rectified_as_it_was_rendered_and_not_without_its_grids() {
    let bench = bench(20.0);
    bench
        .run(&[&["render"], &EXPOSURE[..], &["--out", "scene"]].concat())
        .ok();
    for name in ["grid-lens.fmcg", "grid-sensor.fmcg"] {
        assert!(bench.path(&format!("scene/{name}")).exists(), "{name}");
    }
    bench
        .run(&["camera-file", "check", "scene/camera.toml"])
        .ok();
    let longest = |camera: &str, out: &str| {
        let mut exposure = EXPOSURE;
        exposure[1] = camera;
        bench
            .run(
                &[
                    &["rectify"],
                    &exposure[..],
                    &["--out", out, "scene/frame.tif"],
                ]
                .concat(),
            )
            .ok();
        let rectified = format!("{out}/frame.tif");
        bench
            .run(&["compare", "scene/rectified.tif", &rectified, "--out", out])
            .ok();
        let summary = json(&bench, &format!("{out}/summary.json"));
        assert!(summary["blocks"].as_u64().unwrap() > 40, "{summary}");
        summary["shift_largest_px"].as_f64().unwrap()
    };
    let with = longest("scene/camera.toml", "with");
    assert!(with < 0.004, "{with} px");
    let without = longest("plain.toml", "without");
    assert!(without > 0.3, "{without} px");
    let bound = json(&bench, "with/frame.json")["accuracy"]["mesh_bound_px"]
        .as_f64()
        .unwrap();
    assert!(bound <= 0.001, "{bound} px");
}

#[test]
fn files_of_other_programs_state_what_the_grids_leave() {
    let bench = bench(2.0);
    for format in ["opencv", "metashape", "micmac", "australis", "opentrackio"] {
        let export = |camera: &str, out: &str| {
            bench
                .run(&["export", format, "--camera", camera, "--out", out])
                .ok();
            json(&bench, &format!("{out}/export.json"))
        };
        let gridded = export("camera.toml", &format!("{format}-grid"));
        let plain = export("plain.toml", &format!("{format}-plain"));
        let largest = |summary: &Value| summary["residual_max_um"].as_f64().unwrap();
        // Two waves of 2 µm.
        assert!(
            (1.5..4.5).contains(&largest(&gridded)),
            "{format}: {gridded}"
        );
        assert!(largest(&plain) < 0.5, "{format}: {plain}");
        assert!(
            gridded["not_held"].to_string().contains("residual grids"),
            "{format}: {gridded}"
        );
        assert!(
            !plain["not_held"].to_string().contains("residual grids"),
            "{format}"
        );
        let limit = [
            "export",
            format,
            "--camera",
            "camera.toml",
            "--out",
            "limit",
        ];
        let answer = bench.run(&[&limit[..], &["--max-residual-um", "0.5"]].concat());
        assert_eq!(answer.code, 1, "{}", answer.stderr);
        assert!(!bench.path("limit").exists());
    }
}

#[test]
fn certificate_states_the_grids_and_its_check_finds_a_changed_or_missing_one() {
    let bench = bench(2.0);
    let make = ["certificate", "--camera", "camera.toml", "--out", "out"];
    bench.run(&make).ok();
    let content = json(&bench, "out/certificate.json");
    let page = fs::read_to_string(bench.path("out/certificate.html")).unwrap();
    let titles = [
        "Distortion at rest, measured − ideal",
        "Residual grids, measured − ideal",
    ];
    assert_eq!(titles.map(|title| page.matches(title).count()), [1, 1]);
    let grids = &content["residual_grids"]["grids"];
    assert_eq!(grids[0]["part"], "lens");
    assert_eq!(grids[1]["file"], "s.fmcg");
    let sum = content["residual_grids"]["largest_um"].as_f64().unwrap();
    assert!((2.0..6.0).contains(&sum), "{sum}");
    assert_eq!(content["proof"]["passed"], true);
    assert!(content["proof"]["points"].as_u64().unwrap() > 0);
    for line in content["exchange"].as_array().unwrap() {
        assert!(
            line["not_held"].to_string().contains("residual grids"),
            "{line}"
        );
    }
    let check = ["certificate", "check", "out"];
    let answer = bench.run(&check).ok();
    assert!(
        answer.stdout.contains("l.fmcg: SHA-256"),
        "{}",
        answer.stdout
    );
    let pdf = fs::read(bench.path("out/certificate.pdf")).unwrap();
    assert!(!pdf.is_empty());
    let good = fs::read(bench.path("out/s.fmcg")).unwrap();
    let mut changed = good.clone();
    changed[60] ^= 1;
    fs::write(bench.path("out/s.fmcg"), &changed).unwrap();
    finds(&bench, "s.fmcg");
    fs::remove_file(bench.path("out/s.fmcg")).unwrap();
    finds(&bench, "s.fmcg: there is no such file");
    fs::write(bench.path("out/s.fmcg"), &good).unwrap();
    bench.run(&check).ok();
    // The same number of bytes with a CRC of its own: another grid.
    let (other, _) = wave_grid(GridCarrier::Sensor, 0.1, 2.0, LATTICE);
    fs::write(bench.path("out/s.fmcg"), other).unwrap();
    finds(&bench, "s.fmcg");
    let text = fs::read_to_string(bench.path("camera.toml")).unwrap();
    fs::create_dir(bench.path("grids")).unwrap();
    fs::copy(bench.path("l.fmcg"), bench.path("grids/l.fmcg")).unwrap();
    fs::write(
        bench.path("camera.toml"),
        text.replace("l.fmcg", "grids/l.fmcg"),
    )
    .unwrap();
    bench
        .run(&make)
        .failed(2, &["camera.toml", "grids/l.fmcg", "another folder"]);
}

/// Checks the certificate, which must fail and say so.
fn finds(bench: &Bench, words: &str) {
    let answer = bench.run(&["certificate", "check", "out"]);
    assert_eq!(answer.code, 1, "{}", answer.stdout);
    assert!(answer.stderr.contains(words), "{words}: {}", answer.stderr);
}

/// Each says why it has no place for grids.
#[test]
fn commands_without_grids_refuse_the_camera_by_name() {
    let bench = bench(20.0);
    let five = "the five coefficients";
    fs::write(bench.path("obs.csv"), "").unwrap();
    for (arguments, why) in [
        (&["budget", "--camera", "camera.toml"][..], "shares"),
        (&["sweep", "--camera", "camera.toml", "--out", "out"], five),
        (
            &["calibrate", "five", "obs.csv", "--camera", "camera.toml"],
            five,
        ),
    ] {
        let words = ["camera.toml, line 15", "[grid]", "residual grids", why];
        bench.run(arguments).failed(2, &words);
    }
    let strip = include_str!("../../scenarios/strip.toml");
    let block = include_str!("../../scenarios/block/ixm-50.toml");
    for (command, scenario) in [("strip", strip), ("block", block)] {
        let camera = scenario.lines().find(|line| line.starts_with("camera = "));
        let scenario = scenario.replace(camera.unwrap(), "camera = \"camera.toml\"");
        fs::write(bench.path("scenario.toml"), scenario).unwrap();
        let arguments = [command, "--scenario", "scenario.toml", "--out", "out"];
        let words = [
            "camera.toml, line 15",
            "[grid]",
            "simulated is the polynomial",
        ];
        bench.run(&arguments).failed(2, &words);
    }
    assert!(!bench.path("out").exists());
}

/// The prediction knows no distortion; the simulated exposure goes through the polynomial, and what
/// the grids would add to it is bounded.
#[test]
fn smear_says_what_the_grids_change_at_most() {
    let smear = |bench: &Bench, camera: &str| {
        let arguments = ["smear", "--vh", "0.1", "--exposure", "1/200", "--camera"];
        bench.run(&[&arguments[..], &[camera]].concat()).ok()
    };
    let bound = |amplitude_um: f64| {
        let bench = bench(amplitude_um);
        let gridded = smear(&bench, "camera.toml");
        assert_eq!(gridded.stdout, smear(&bench, "plain.toml").stdout);
        let (_, rest) = gridded.stderr.split_once("at most ").unwrap();
        rest.split_once(" µm").unwrap().0.parse::<f64>().unwrap()
    };
    let (small, large) = (bound(2.0), bound(20.0));
    // δ = 20 mm · 0.1/s · 5 ms = 10 µm, and a slope of 2 µm · 1.4/mm of both grids: 0.06 µm.
    assert!((0.02..0.1).contains(&small), "{small}");
    assert!((9.0..12.0).contains(&(large / small)), "{large} {small}");
    let bench = bench(2.0);
    assert!(
        !smear(&bench, "plain.toml")
            .stderr
            .contains("residual grids")
    );
}
