//! `calibrate angles`.

use std::fs;

use fmc_camera_file::CameraFile;

use crate::command_line::calibration_files::{
    INTERIOR, K1, RUN_OUT, angles_csv, assert_complete, calibrated, field_angles_csv, parameter,
    summary,
};

#[test]
fn line_gives_methods_bands_and_camera_file() {
    let (bench, answer) = calibrated("angles", &angles_csv(), &["--sigma-l-um", "0.2"]);
    let answer = answer.ok();
    assert!(answer.stdout.contains("quartic (6)"), "{}", answer.stdout);
    assert_complete(&bench, &answer, "out");
    let summary = summary(&bench, "out/summary.json");
    let [f, x0, _] = INTERIOR;
    for (name, truth) in [("principal_distance_mm", f), ("x0_mm", x0), ("k1", K1)] {
        let (value, sigma) = parameter(&summary, name);
        assert!(
            (value - truth).abs() < 5.0 * sigma,
            "{name} {value} ± {sigma}"
        );
    }
    let methods = summary["methods"].as_array().unwrap();
    let names: Vec<&str> = methods
        .iter()
        .map(|one| one["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["(2)", "(3)", "(4)", "quartic (6)", "direct", "exact"]
    );
    assert_eq!(summary["bands"].as_array().unwrap().len(), 2);
    assert!(summary["repeatability_um"].as_f64().unwrap() < 0.5);
    let table = fs::read_to_string(bench.path("out/distortion.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 116 + 2 * 58);
}

#[test]
fn bad_angles_are_refused() {
    let good = angles_csv();
    let refused = |text: &str, words: &[&str]| {
        let (_, answer) = calibrated("angles", text, &[]);
        answer.refused(words);
    };
    refused(
        &good.replacen("-18.0", "-91.0", 1),
        &["line 2", "angle_deg = -91", "-89 to 89"],
    );
    let few: Vec<&str> = good.lines().take(5).collect();
    refused(
        &few.join("\n"),
        &["4 observations do not suffice for 5 unknowns"],
    );
    refused(
        &good.replacen("l_mm", "l_um", 1),
        &["column l_mm is missing"],
    );
    let radians: String = good
        .lines()
        .enumerate()
        .map(|(index, line)| match line.split_once(',') {
            Some((angle, rest)) if index > 0 => {
                format!("{},{rest}\n", angle.parse::<f64>().unwrap().to_radians())
            }
            _ => format!("{line}\n"),
        })
        .collect();
    refused(&radians, &["radians"]);
}

#[test]
fn area_gives_camera_file_and_stage() {
    let text = field_angles_csv(&[-0.5, 0.0, 0.5]);
    let (bench, answer) = calibrated(
        "angles",
        &text,
        &["--estimate", "f,x0,y0,k1,k2,k3,p1,p2,b1,b2"],
    );
    let answer = answer.ok();
    for word in [
        "Stage",
        "run-out z1",
        "axis check",
        "Camera on the turntable",
    ] {
        assert!(answer.stdout.contains(word), "{word}\n{}", answer.stdout);
    }
    assert_complete(&bench, &answer, "out");
    let summary = summary(&bench, "out/summary.json");
    let [f, x0, y0] = INTERIOR;
    let [z1, z2] = RUN_OUT;
    for (name, truth) in [
        ("principal_distance_mm", f),
        ("x0_mm", x0),
        ("y0_mm", y0),
        ("k1", K1),
        ("stage_scale", 0.0),
        ("stage_axis_angle_rad", 0.0),
        ("run_out_mm_per_mm", z1),
        ("run_out_mm_per_mm2", z2),
    ] {
        let (value, sigma) = parameter(&summary, name);
        assert!(
            (value - truth).abs() < 4.0 * sigma,
            "{name} {value} ± {sigma}"
        );
    }
    assert_eq!(summary["stage"]["offsets"], 3);
    assert!(summary["mount"]["sigma_roll_deg"].as_f64().unwrap() > 0.0);
    let (camera, _) = CameraFile::read(&bench.path("out/camera.toml")).unwrap();
    let [_, linear, square] = camera.fmc.flatness_um[..] else {
        panic!("{:?}", camera.fmc.flatness_um);
    };
    let stated = |name| 1e3 * parameter(&summary, name).0;
    assert!((linear - stated("run_out_mm_per_mm")).abs() < 1e-9);
    assert!((square - stated("run_out_mm_per_mm2")).abs() < 1e-9);
    let page = fs::read_to_string(bench.path("out/certificate.html")).unwrap();
    assert!(page.contains("run-out z2, µm/mm²"));
    let certificate = fs::read_to_string(bench.path("certificate/certificate.html")).unwrap();
    for name in ["stage_scale", "stage_axis_angle_rad", "run_out_mm_per_mm2"] {
        assert!(certificate.contains(name), "{name}");
    }
}

#[test]
fn area_without_stage_keeps_the_run_out() {
    let text = field_angles_csv(&[0.0]).replace(",stage_offset_mm", ",note");
    let (bench, answer) = calibrated("angles", &text, &["--sigma-angle-arcsec", "1"]);
    let answer = answer.ok();
    assert!(
        answer
            .stdout
            .contains("its run-out stays that of the camera file"),
        "{}",
        answer.stdout
    );
    let (camera, _) = CameraFile::read(&bench.path("out/camera.toml")).unwrap();
    assert_eq!(camera.fmc.flatness_um.len(), 2);
    assert!(summary(&bench, "out/summary.json")["stage"].is_null());
}

#[test]
fn bad_directions_are_refused() {
    let good = field_angles_csv(&[-0.5, 0.5]);
    let refused = |text: &str, more: &[&str], words: &[&str]| {
        let (bench, answer) = calibrated("angles", text, more);
        answer.refused(words);
        assert!(!bench.path("out").exists());
    };
    let without_header = |header: &str| {
        let (_, rows) = good.split_once('\n').unwrap();
        format!("{header}\n{rows}")
    };
    refused(
        &without_header("azimuth_deg,elevation_deg,x_mm,y_mm,angle_deg"),
        &[],
        &["line 1", "both angle_deg and azimuth_deg are given"],
    );
    refused(
        &without_header("azimuth_deg,azimuth_deg,x_mm,y_mm,stage_offset_mm"),
        &[],
        &["line 1", "column azimuth_deg appears twice"],
    );
    refused(
        &without_header("azimuth_deg,elevation_rad,x_mm,y_mm,stage_offset_mm"),
        &[],
        &["line 1", "column elevation_deg is missing"],
    );
    refused(
        &without_header("azimuth_deg,elevation_deg,x_um,y_um,stage_offset_mm"),
        &[],
        &[
            "line 1",
            "columns x_mm and y_mm, or col_px and row_px, are missing",
        ],
    );
    refused(
        &good.replacen("-21,-19,", "-91,-19,", 1),
        &[],
        &["obs.csv, line 2", "azimuth_deg = -91", "-89 to 89"],
    );
    refused(
        &good.replacen("-21,-19,", "-21,NaN,", 1),
        &[],
        &[
            "obs.csv, line 2",
            "elevation_deg = \"NaN\" is not a finite number",
        ],
    );
    refused(
        &good.replacen(",-0.5\n", ",\n", 1),
        &[],
        &[
            "obs.csv, line 2",
            "stage_offset_mm",
            "is not a finite number",
        ],
    );
    refused(
        &field_angles_csv(&[0.5, 0.5]),
        &[],
        &[
            "obs.csv: stage_offset_mm is between 0.5 and 0.5",
            "tells nothing about the stage",
        ],
    );
    let few: Vec<&str> = good.lines().take(5).collect();
    refused(
        &few.join("\n").replace(",stage_offset_mm", ",note"),
        &[],
        &["8 observations do not suffice for 11 unknowns"],
    );
    let changed = |column: usize, factor: f64| {
        let mut lines = good.lines();
        let mut text = format!("{}\n", lines.next().unwrap());
        for line in lines {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            cells[column] = (factor * cells[column].parse::<f64>().unwrap()).to_string();
            text += &(cells.join(",") + "\n");
        }
        text
    };
    refused(
        &changed(0, 1_f64.to_radians()),
        &[],
        &["x_mm over the tangent of azimuth_deg", "radians"],
    );
    refused(&changed(2, 1e3), &[], &["line 2", "off the sensor", "µm"]);
    refused(
        &changed(3, -1.0),
        &[],
        &["y_mm falls with elevation_deg", "upwards"],
    );
    refused(&changed(4, -1.0), &[], &["counts against fmc.axis"]);
    refused(&good, &["--along", "y"], &["--along", "is of an area"]);
    refused(&good, &["--estimate", "f,q"], &["q is none of f, x0"]);
    refused(&good, &["--estimate", "f,f"], &["f appears twice"]);
    refused(
        &angles_csv(),
        &["--estimate", "f"],
        &["--estimate", "one line of the sensor"],
    );
}
