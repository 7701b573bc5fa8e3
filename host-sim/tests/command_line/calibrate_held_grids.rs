//! Calibrations of cameras with residual grids: the grids are held, and the camera file that is
//! written keeps them.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::fs;

use fmc_camera::geometry::grid::GridCarrier;
use fmc_reference::residual_splines::ResidualSplines;
use serde_json::Value;

use crate::command_line::calibration_files::{
    INTERIOR, K1, assert_complete, assert_reports, field_angles_csv, field_csv, parameter,
    plane_csv, summary,
};
use crate::command_line::flight_block::{Block, RunUp};
use crate::command_line::lens_with_grids::{Lens, with_points};
use crate::command_line::support::{Answer, Bench};
use crate::command_line::wave_grid::{Lattice, WaveGrids, wave_grid};

/// Camera of the laboratory before its calibration.
const CAMERA: &str = r#"name = "Laboratory"
principal_distance_mm = 100.0
exit_pupil_mm = 110.0
principal_point_mm = [0.03, -0.05]
[sensor]
width_px = 9216
height_px = 9216
pixel_um = 8.75
[fmc]
stroke_mm = 4.0
"#;

/// Covers the sensor of the block, and the stroke of its camera.
const OF_BLOCK: Lattice = Lattice {
    nodes: 32,
    pitch_mm: 2.0,
};

/// Covers the sensor of the test camera, and its stroke.
const OF_LABORATORY: Lattice = Lattice {
    nodes: 48,
    pitch_mm: 2.0,
};

/// Writes a camera file with grids, and them.
fn put(bench: &Bench, name: &str, camera: &str, grids: &WaveGrids) {
    fs::write(bench.path(name), format!("{camera}{}", grids.table)).unwrap();
    for (name, bytes) in grids.files() {
        fs::write(bench.path(name), bytes).unwrap();
    }
}

/// Checks that the folder has a camera with the grids, and reports that say so.
fn assert_held(bench: &Bench, answer: &Answer, folder: &str, grids: &WaveGrids) {
    let [lens, sensor] = [&grids.lens, &grids.sensor].map(|file| {
        let crc = u32::from_le_bytes(*file.last_chunk().unwrap());
        format!("{crc:08x}")
    });
    let summary = summary(bench, &format!("{folder}/summary.json"));
    let held = &summary["held_grids"];
    assert_eq!(held.as_array().unwrap().len(), 2);
    for (held, part, file, crc) in [
        (&held[0], "lens", "grid-lens.fmcg", &lens),
        (&held[1], "sensor", "grid-sensor.fmcg", &sensor),
    ] {
        assert_eq!(held["frame"], part);
        assert_eq!(held["file"], file);
        assert_eq!(held["crc32"], **crc);
    }
    let copies = ["grid-lens.fmcg", "grid-sensor.fmcg"];
    let copies = copies.map(|name| fs::read(bench.path(&format!("{folder}/{name}"))).unwrap());
    assert!(copies == [grids.lens.clone(), grids.sensor.clone()]);
    let camera = format!("{folder}/camera.toml");
    let text = fs::read_to_string(bench.path(&camera)).unwrap();
    assert_eq!(text.matches("[grid]").count(), 1, "{text}");
    for line in [
        "lens = \"grid-lens.fmcg\"".to_owned(),
        format!("lens_crc32 = \"{lens}\""),
        "sensor = \"grid-sensor.fmcg\"".to_owned(),
        format!("sensor_crc32 = \"{sensor}\""),
    ] {
        assert!(text.lines().any(|one| one == line), "{line}\n{text}");
    }
    bench.run(&["camera-file", "check", &camera]).ok();
    let page = fs::read_to_string(bench.path(&format!("{folder}/certificate.html"))).unwrap();
    for text in [&answer.stdout, &page] {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for words in [
            "the residual grids of the camera file were held",
            "belongs with them, and with no others",
            &lens,
            &sensor,
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
    }
}

const FROM_REST: Block = Block {
    run_up: RunUp::FromRest,
    seed: 2,
    fault_mm: 0.0,
    at_trigger: false,
    scale: 0.0,
};

/// A block with records whose image points are those of a lens with these grids, in
/// `gridded.csv`, beside those of the polynomial alone in `image_points.csv`; `camera.toml` has the
/// grids, `plain.toml` has none.
fn flown(grids: &WaveGrids) -> Bench {
    let bench = FROM_REST.bench();
    let camera = fs::read_to_string(bench.path("camera.toml")).unwrap();
    fs::write(bench.path("plain.toml"), &camera).unwrap();
    put(&bench, "camera.toml", &camera, grids);
    let splines = grids.splines();
    let records = fs::read_to_string(bench.path("records.csv")).unwrap();
    let setting = |sequence: &str| -> [f64; 2] {
        let row = records
            .lines()
            .find(|row| row.split(',').next() == Some(sequence))
            .unwrap();
        let cells: Vec<&str> = row.split(',').collect();
        [7, 8].map(|place| cells[place].parse().unwrap())
    };
    let points = fs::read_to_string(bench.path("image_points.csv")).unwrap();
    // The grids may put points off the sensor.
    let mut near_the_edge = HashSet::new();
    with_points(&points, |cells, [x, y]| {
        if x.abs() > 26.6 || y.abs() > 19.9 {
            near_the_edge.insert(cells[1].to_owned());
        }
        [x, y]
    });
    let is_kept = |row: &&str| !near_the_edge.contains(row.split(',').nth(1).unwrap());
    let kept: Vec<&str> = points.lines().filter(is_kept).collect();
    let points = kept.join("\n") + "\n";
    fs::write(bench.path("image_points.csv"), &points).unwrap();
    let gridded = with_points(&points, |cells, point| {
        let [offset_mm, focus_mm] = setting(cells[0]);
        let lens = Lens {
            principal_point_mm: [0.02, -0.01],
            k1: -2e-6,
            offset_mm,
            scale: 1.0 + focus_mm / 50.0,
            grids: &splines,
        };
        lens.measured(point)
    });
    fs::write(bench.path("gridded.csv"), gridded).unwrap();
    bench
}

fn bundle(bench: &Bench, points: &str, camera: &str, out: &str, more: &[&str]) -> Answer {
    let arguments = [
        "calibrate",
        "bundle",
        points,
        "--points",
        "points.csv",
        "--images",
        "images.csv",
        "--camera",
        camera,
        "--estimate",
        "x0,y0,k1,p1",
        "--out",
        out,
    ];
    bench.run(&[&arguments, more].concat())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The same flight through the polynomial alone is the truth: noise included.
#[test]
fn block_with_records_is_that_of_the_polynomial_and_without_the_grids_it_is_not() {
    let grids = WaveGrids::new(5.0, OF_BLOCK);
    let bench = flown(&grids);
    let records = ["--records", "records.csv"];
    let answer = bundle(&bench, "gridded.csv", "camera.toml", "out", &records).ok();
    assert_complete(&bench, &answer, "out");
    assert_held(&bench, &answer, "out", &grids);
    bundle(&bench, "image_points.csv", "plain.toml", "truth", &records).ok();
    let [found, truth] =
        ["out", "truth"].map(|out| summary(&bench, &format!("{out}/summary.json")));
    assert!(truth["held_grids"].is_null());
    for name in ["x0_mm", "y0_mm", "k1", "p1"] {
        let ((found, _), (truth, sigma)) = (parameter(&found, name), parameter(&truth, name));
        assert!(
            (found - truth).abs() < 0.01 * sigma,
            "{name}: {found} {truth} ± {sigma}"
        );
    }
    for (found, truth) in [
        (&found["sigma0"], &truth["sigma0"]),
        (
            &found["static_bundle"]["sigma0"],
            &truth["static_bundle"]["sigma0"],
        ),
    ] {
        assert!(
            (number(found) - number(truth)).abs() < 2e-3,
            "{found} {truth}"
        );
    }
    let images = found["images"].as_array().unwrap();
    for (found, truth) in images.iter().zip(truth["images"].as_array().unwrap()) {
        for axis in 0..3 {
            let error = number(&found["position_m"][axis]) - number(&truth["position_m"][axis]);
            assert!(error.abs() < 1e-3, "{error}");
        }
    }
    bundle(&bench, "gridded.csv", "plain.toml", "without", &records).ok();
    let without = summary(&bench, "without/summary.json");
    assert!(number(&without["sigma0"]) > 2.5, "{}", without["sigma0"]);
    // The certificate that goes with the calibration states its grids, and takes no others.
    let certificate = summary(&bench, "certificate/certificate.json");
    let held = &certificate["parameters"]["calibrations"][0]["held_grids"];
    assert_eq!(held.as_array().unwrap().len(), 2, "{held}");
    let page = fs::read_to_string(bench.path("certificate/certificate.html")).unwrap();
    assert!(page.contains("residual grids held"));
    let text = fs::read_to_string(bench.path("out/camera.toml")).unwrap();
    let (other, crc) = wave_grid(GridCarrier::Lens, 0.7, 5.0, OF_BLOCK);
    fs::write(bench.path("out/other.fmcg"), other).unwrap();
    let known = u32::from_le_bytes(*grids.lens.last_chunk().unwrap());
    let text = text
        .replace("grid-lens.fmcg", "other.fmcg")
        .replace(&format!("{known:08x}"), &format!("{crc:08x}"));
    fs::write(bench.path("out/camera.toml"), text).unwrap();
    let certificate = ["certificate", "--camera", "out/camera.toml"];
    let calibration = ["--calibration", "out/summary.json", "--out", "other"];
    bench
        .run(&[&certificate[..], &calibration].concat())
        .failed(
            2,
            &[
                "out/summary.json",
                "held residual grid of the lens",
                &format!("{crc:08x}"),
            ],
        );
    assert!(!bench.path("other").exists());
}

/// A block that is handed over has no distortion: polynomial and grids are off.
#[test]
fn block_that_is_handed_over_has_the_grids_taken_off() {
    let grids = WaveGrids::new(5.0, OF_BLOCK);
    let bench = flown(&grids);
    let more = [
        "--records",
        "records.csv",
        "--export",
        "csv",
        "--estimate",
        "none",
    ];
    let run = |points: &str, camera: &str, out: &str| {
        let arguments = [
            "calibrate",
            "bundle",
            points,
            "--points",
            "points.csv",
            "--images",
            "images.csv",
            "--camera",
            camera,
            "--keep-all",
            "--out",
            out,
        ];
        bench.run(&[&arguments[..], &more].concat()).ok();
        let path = bench.path(&format!("{out}/corrected_points.csv"));
        let mut rows = csv::Reader::from_path(path).unwrap();
        let header = rows.headers().unwrap().clone();
        let places =
            ["x_mm", "y_mm"].map(|name| header.iter().position(|one| one == name).unwrap());
        let cells = |row: csv::StringRecord| places.map(|place| row[place].parse::<f64>().unwrap());
        let rows = rows.records().map(|row| cells(row.unwrap()));
        rows.collect::<Vec<_>>()
    };
    let found = run("gridded.csv", "camera.toml", "out");
    let truth = run("image_points.csv", "plain.toml", "truth");
    assert!(found.len() > 1000 && found.len() == truth.len());
    let pairs = found.iter().flatten().zip(truth.iter().flatten());
    let largest = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(largest < 2e-6, "{largest} mm");
}

/// Without records the stage rests in all images.
#[test]
fn resection_and_a_network_at_rest_hold_the_grids() {
    let bench = Bench::with(CAMERA, b"");
    let grids = WaveGrids::new(5.0, OF_LABORATORY);
    put(&bench, "camera.toml", CAMERA, &grids);
    fs::write(bench.path("plain.toml"), CAMERA).unwrap();
    let splines = grids.splines();
    let field = laboratory(&field_csv(0.3), &splines);
    let (mut points, mut objects) = (
        "image,point,x_mm,y_mm,sigma_um\n".to_owned(),
        "point,x_m,y_m,z_m,role\n".to_owned(),
    );
    for line in field.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        writeln!(points, "1,{},{},{},0.3", cells[0], cells[1], cells[2]).unwrap();
        let [x, y, z] = [cells[3], cells[4], cells[5]];
        writeln!(objects, "{},{x},{y},{z},control", cells[0]).unwrap();
    }
    fs::write(bench.path("image_points.csv"), points).unwrap();
    fs::write(bench.path("objects.csv"), objects).unwrap();
    for method in ["resection", "bundle"] {
        let run = |camera: &str, out: &str| {
            let arguments = [
                "calibrate",
                method,
                "image_points.csv",
                "--points",
                "objects.csv",
                "--camera",
                camera,
                "--estimate",
                "f,x0,y0,k1",
                "--out",
                out,
            ];
            let answer = bench.run(&arguments).ok();
            (answer, summary(&bench, &format!("{out}/summary.json")))
        };
        let (answer, found) = run("camera.toml", method);
        assert_complete(&bench, &answer, method);
        assert_held(&bench, &answer, method, &grids);
        assert_laboratory(&found);
        let (_, without) = run("plain.toml", &format!("{method}-without"));
        assert!(number(&without["sigma0"]) > 5.0 * number(&found["sigma0"]));
    }
}

/// Returns a table of the laboratory's lens with the points of that lens with grids.
fn laboratory(text: &str, splines: &ResidualSplines) -> String {
    let [_, x0, y0] = INTERIOR;
    let lens = |offset_mm: f64, scale: f64| Lens {
        principal_point_mm: [x0, y0],
        k1: K1,
        offset_mm,
        scale,
        grids: splines,
    };
    let has_stage = text.starts_with("azimuth_deg");
    with_points(text, |cells, point| {
        let c = if has_stage {
            cells.last().unwrap().parse().unwrap()
        } else {
            0.0
        };
        let [z1, z2] = crate::command_line::calibration_files::RUN_OUT;
        lens(c, 1.0 + (z1 * c + z2 * c * c) / 110.0).measured(point)
    })
}

/// Checks interior orientation and K1 against those of the laboratory, within 4 σ and a micrometre.
fn assert_laboratory(summary: &Value) {
    let truth = [INTERIOR[0], INTERIOR[1], INTERIOR[2], K1];
    for (name, truth) in ["principal_distance_mm", "x0_mm", "y0_mm", "k1"]
        .into_iter()
        .zip(truth)
    {
        let (value, sigma) = parameter(summary, name);
        assert!(
            (value - truth).abs() < 4.0 * sigma + 1e-12,
            "{name}: {value} {truth} ± {sigma}"
        );
        if name != "k1" {
            assert!((value - truth).abs() < 0.01, "{name}: {value} {truth}");
        }
    }
}

/// Runs a method of the laboratory with the grids, and returns the bench.
fn calibrated(method: &str, text: &str, grids: &WaveGrids, more: &[&str]) -> (Bench, Answer) {
    let bench = Bench::with(CAMERA, b"");
    put(&bench, "camera.toml", CAMERA, grids);
    fs::write(bench.path("plain.toml"), CAMERA).unwrap();
    fs::write(bench.path("obs.csv"), laboratory(text, &grids.splines())).unwrap();
    let arguments = ["calibrate", method, "obs.csv", "--out", "out", "--camera"];
    let answer = bench
        .run(&[&arguments[..], &["camera.toml"], more].concat())
        .ok();
    let without = [
        "calibrate",
        method,
        "obs.csv",
        "--out",
        "without",
        "--camera",
    ];
    bench
        .run(&[&without[..], &["plain.toml"], more].concat())
        .ok();
    (bench, answer)
}

#[test]
fn methods_of_the_laboratory_hold_the_grids() {
    let grids = WaveGrids::new(5.0, OF_LABORATORY);
    for (method, text, more) in [
        ("dlt3d", field_csv(0.3), &["--estimate", "k1"][..]),
        ("dlt2d", plane_csv(&[]), &["--estimate", "k1"]),
        (
            "angles",
            field_angles_csv(&[-1.0, 0.0, 1.0]),
            &["--estimate", "f,x0,y0,k1"],
        ),
    ] {
        let (bench, answer) = calibrated(method, &text, &grids, more);
        assert_held(&bench, &answer, "out", &grids);
        assert_reports(&bench, &answer, "out");
        let [found, without] =
            ["out", "without"].map(|out| summary(&bench, &format!("{out}/summary.json")));
        if method == "dlt2d" {
            let (k1, _) = parameter(&found, "k1");
            let (other, _) = parameter(&without, "k1");
            assert!((k1 - K1).abs() < 1e-14, "{k1}");
            assert!((other - K1).abs() > 1e-12, "{other}");
        } else {
            assert_laboratory(&found);
        }
        let [found, without] = [found, without].map(|one| number(&one["residual_rms_um"]));
        assert!(found < 0.5 && without > 2.0, "{method}: {found} {without}");
    }
}

#[test]
fn later_run_with_one_grid_leaves_no_stale_one_of_the_other_part() {
    let grids = WaveGrids::new(5.0, OF_LABORATORY);
    let (bench, _) = calibrated("dlt3d", &field_csv(0.3), &grids, &["--estimate", "k1"]);
    let sensor = bench.path("out/grid-sensor.fmcg");
    assert!(sensor.exists());
    let lines = grids.table.lines();
    let table: Vec<&str> = lines.filter(|line| !line.starts_with("sensor")).collect();
    let text = format!("{CAMERA}{}\n", table.join("\n"));
    fs::write(bench.path("camera.toml"), text).unwrap();
    let again = ["calibrate", "dlt3d", "obs.csv", "--camera", "camera.toml"];
    bench.run(&[&again[..], &["--out", "out"]].concat()).ok();
    assert!(!sensor.exists());
    assert!(bench.path("out/grid-lens.fmcg").exists());
    let held = summary(&bench, "out/summary.json")["held_grids"].clone();
    assert_eq!(held.as_array().unwrap().len(), 1);
    // A damaged grid is named, and nothing is written.
    fs::write(bench.path("l.fmcg"), &grids.lens[..1000]).unwrap();
    bench
        .run(&[&again[..], &["--out", "none"]].concat())
        .failed(2, &["camera.toml", "grid.lens", "1000 bytes"]);
    assert!(!bench.path("none").exists());
}

#[test]
fn one_line_of_the_sensor_takes_no_grids() {
    let bench = Bench::with(CAMERA, b"");
    put(
        &bench,
        "camera.toml",
        CAMERA,
        &WaveGrids::new(5.0, OF_LABORATORY),
    );
    let text = crate::command_line::calibration_files::angles_csv();
    fs::write(bench.path("obs.csv"), text).unwrap();
    let arguments = ["calibrate", "angles", "obs.csv", "--camera", "camera.toml"];
    bench
        .run(&[&arguments[..], &["--out", "out"]].concat())
        .failed(
            2,
            &["camera.toml", "[grid]", "one line of the sensor", "obs.csv"],
        );
    assert!(!bench.path("out").exists());
}
