//! `calibrate dlt3d` and `calibrate dlt2d`.

use std::fs;

use crate::command_line::calibration_files::{
    INTERIOR, K1, assert_complete, calibrated, field_csv, parameter, plane_csv, summary,
};
use crate::command_line::support::Bench;

#[test]
fn spatial_field_gives_the_camera_back() {
    let (bench, answer) = calibrated(
        "dlt3d",
        &field_csv(0.0),
        &["--estimate", "k1,p1,p2", "--keep-all"],
    );
    let answer = answer.ok();
    assert_complete(&bench, &answer, "out");
    let summary = summary(&bench, "out/summary.json");
    let [f, x0, y0] = INTERIOR;
    // K2 is held at that of the camera file, which the simulated lens has not.
    assert!((parameter(&summary, "principal_distance_mm").0 - f).abs() < 0.2);
    assert_eq!(parameter(&summary, "k2"), (2e-10, 0.0));
    assert_eq!(summary["redundancy"], 120 - 14);
    assert_eq!(summary["l"].as_array().unwrap().len(), 11);
    let (bench, answer) = calibrated("dlt3d", &field_csv(0.0), &["--estimate", "k1,k2,k3,p1,p2"]);
    answer.ok();
    let exact = self::summary(&bench, "out/summary.json");
    for (name, truth) in [("principal_distance_mm", f), ("x0_mm", x0), ("y0_mm", y0)] {
        let (value, _) = parameter(&exact, name);
        assert!((value - truth).abs() < 1e-8, "{name} {value}");
    }
    assert!((parameter(&exact, "k1").0 - K1).abs() < 1e-12);
    // The camera file holds them, and its own comments and tables.
    let text = fs::read_to_string(bench.path("out/camera.toml")).unwrap();
    assert!(text.contains("principal_distance_mm = 100.5"), "{text}");
    assert!(text.contains("[shutter]") && text.contains("strategy = \"centred\""));
    bench.run(&["camera-file", "check", "out/camera.toml"]).ok();
}

#[test]
fn sigma_is_stated_with_and_without_sigma0() {
    let (bench, answer) = calibrated(
        "dlt3d",
        &field_csv(1.0),
        &["--estimate", "k1,k2,k3,p1,p2", "--date", "2026-03-14"],
    );
    answer.ok();
    let summary = summary(&bench, "out/summary.json");
    let sigma0 = summary["sigma0"].as_f64().unwrap();
    assert!(sigma0 > 0.5 && sigma0 < 1.2, "{sigma0}");
    let f = &summary["parameters"][0];
    let ratio = f["sigma"].as_f64().unwrap() / f["sigma_a_priori"].as_f64().unwrap();
    assert!((ratio / sigma0 - 1.0).abs() < 1e-12);
    let page = fs::read_to_string(bench.path("out/certificate.html")).unwrap();
    assert!(page.contains("2026-03-14"));
}

#[test]
fn plane_target_gives_table_and_camera_file() {
    let (bench, answer) = calibrated(
        "dlt2d",
        &plane_csv(&[]),
        &["--corners", "0,14,210,224", "--keep-all"],
    );
    let answer = answer.ok();
    assert!(
        answer.stdout.contains("moving quadric"),
        "{}",
        answer.stdout
    );
    assert_complete(&bench, &answer, "out");
    let summary = summary(&bench, "out/summary.json");
    // f and principal point are those of the camera file.
    assert_eq!(parameter(&summary, "principal_distance_mm"), (100.0, 0.0));
    assert_eq!(summary["interpolation"].as_array().unwrap().len(), 4);
    let table = fs::read_to_string(bench.path("out/table.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 226);
    assert_eq!(rows[0], "target,x_mm,y_mm,dx_um,dy_um");
    for corner in [1, 15, 211, 225] {
        let numbers: Vec<f64> = rows[corner]
            .split(',')
            .skip(3)
            .map(|cell| cell.parse().unwrap())
            .collect();
        assert!(numbers.iter().all(|um| um.abs() < 1e-6), "{numbers:?}");
    }
    for figure in 3..=10 {
        assert!(bench.path(&format!("out/figure-{figure}.svg")).exists());
    }
    let gauge = summary["gauge"]["principal_distance_mm"].as_f64().unwrap();
    // K1·R² of 0.08 % at the corners, with f of the camera file.
    assert!((gauge / 100.0 - 1.0).abs() > 1e-4, "{gauge}");
}

/// Moves the measured points of a plane target by 3 µm of waves of 40 mm.
fn with_waves(text: &str) -> String {
    let wave = |along: f64| 3e-3 * (std::f64::consts::TAU * along / 40.0).sin();
    let mut lines = vec![text.lines().next().unwrap().to_owned()];
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [x, y] = [1, 2].map(|column: usize| cells[column].parse::<f64>().unwrap());
        let [x, y] = [x + wave(x + 0.5 * y + 3.0), y + wave(y - 0.7 * x + 8.0)];
        let rest = cells[3..].join(",");
        lines.push(format!("{},{x:.12},{y:.12},{rest}", cells[0]));
    }
    lines.join("\n") + "\n"
}

#[test]
fn leftover_of_a_plane_target_is_a_grid_of_the_camera() {
    let targets = with_waves(&plane_csv(&[]));
    let grid = ["--keep-all", "--grid", "--pitch-mm", "4"];
    let (bench, answer) = calibrated("dlt2d", &targets, &grid);
    let answer = answer.ok();
    assert!(
        answer.stdout.contains("Residual grids"),
        "{}",
        answer.stdout
    );
    assert_complete(&bench, &answer, "out");
    let found = summary(&bench, "out/summary.json");
    assert_eq!(found["method"], "dlt2d");
    assert_eq!(found["grids"][0]["frame"], "lens");
    let [alone, camera] = ["polynomial_alone", "polynomial_and_grid"]
        .map(|key| found[key]["rms_um"].as_f64().unwrap());
    assert!(alone > 1.0 && camera < 0.05, "{alone} {camera} µm");
    // The camera with its grid is accepted, also by a calibration without --grid, which holds it.
    let check = ["camera-file", "check", "out/camera.toml"];
    bench.run(&check).ok();
    assert!(bench.path("out/grid-lens.fmcg").exists());
    for file in ["camera.toml", "grid-lens.fmcg"] {
        fs::copy(bench.path(&format!("out/{file}")), bench.path(file)).unwrap();
    }
    fs::write(bench.path("targets.csv"), &targets).unwrap();
    let again = [
        "calibrate",
        "dlt2d",
        "targets.csv",
        "--camera",
        "camera.toml",
    ];
    bench.run(&[&again[..], &["--out", "held"]].concat()).ok();
    let held = summary(&bench, "held/summary.json");
    assert_eq!(held["held_grids"][0]["frame"], "lens", "{held}");
    let sensor = ["--frame", "sensor", "--out", "out"];
    bench.run(&[&again[..], &grid, &sensor].concat()).ok();
    assert!(bench.path("out/grid-sensor.fmcg").exists());
    assert!(!bench.path("out/grid-lens.fmcg").exists());
    for (more, words) in [
        (&["--grid"][..], &["--pitch-mm"][..]),
        (&["--pitch-mm", "4"], &["--grid"]),
        (&["--grid", "--pitch-mm", "0.5"], &["pitch 0.5 mm", "4096"]),
        (&["--grid", "--pitch-mm", "4", "--frame", "both"], &["both"]),
    ] {
        bench.run(&[&again[..], more].concat()).refused(words);
    }
}

#[test]
fn each_focus_setting_has_a_folder() {
    let (bench, answer) = calibrated("dlt2d", &plane_csv(&["near", "far"]), &[]);
    answer.ok();
    for focus in ["near", "far"] {
        let summary = summary(&bench, &format!("out/focus-{focus}/summary.json"));
        assert_eq!(summary["focus"], focus);
        assert!(
            bench
                .path(&format!("out/focus-{focus}/camera.toml"))
                .exists()
        );
    }
}

#[test]
fn bad_observations_are_refused_with_line_and_column() {
    let good = field_csv(0.0);
    let refused = |change: &dyn Fn(&str) -> String, words: &[&str]| {
        let (bench, answer) = calibrated("dlt3d", &change(&good), &[]);
        answer.refused(words);
        assert!(!bench.path("out").exists());
    };
    let lines = |count: usize| good.lines().take(count).collect::<Vec<_>>().join("\n");
    refused(&|_| lines(6), &["5 points", "at least 6"]);
    refused(
        &|text| text.replace("\n7,", "\n8,"),
        &["lines 9 and 10", "point 8 appears twice"],
    );
    refused(
        &|text| text.replacen(",1\n", ",0\n", 1),
        &["line 2", "sigma_um"],
    );
    refused(
        &|text| text.replacen(",1\n", ",-1\n", 1),
        &["line 2", "sigma_um"],
    );
    refused(
        &|text| text.replacen(",1\n", ",nan\n", 1),
        &["line 2", "sigma_um", "nan"],
    );
    refused(
        &|text| text.replacen("z_m", "h_m", 1),
        &["line 1", "column z_m is missing"],
    );
    refused(
        &|text| text.replacen("x_mm,y_mm", "x_mm,row_px", 1),
        &["columns x_mm and y_mm"],
    );
    // Millimetres typed as µm are far off the sensor.
    let micrometres = |text: &str| {
        let row = |line: &str| {
            let cells: Vec<String> = line
                .split(',')
                .enumerate()
                .map(|(index, cell)| match index {
                    1 | 2 => format!("{}", 1e3 * cell.parse::<f64>().unwrap()),
                    _ => cell.to_owned(),
                })
                .collect();
            cells.join(",")
        };
        let mut lines = text.lines();
        let header = lines.next().unwrap().to_owned();
        std::iter::once(header)
            .chain(lines.map(row))
            .collect::<Vec<_>>()
            .join("\n")
    };
    refused(&micrometres, &["off the sensor", "µm"]);
    refused(&|_| String::new(), &["line 1", "empty"]);
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let bench = Bench::new();
    fs::write(bench.path("obs.csv"), field_csv(0.0)).unwrap();
    let run = |more: &[&str]| {
        let arguments = ["calibrate", "dlt3d", "obs.csv", "--camera", "camera.toml"];
        bench.run(&[&arguments, more].concat())
    };
    run(&["--estimate", "k4"]).refused(&["k4", "k1, k2, k3, p1, p2"]);
    run(&["--date", "14.3.2026"]).refused(&["--date", "YYYY-MM-DD"]);
    run(&["--estimate", "f,x0,y0,k1"]).ok();
    let (_, answer) = calibrated("dlt2d", &plane_csv(&[]), &["--corners", "0,14,210"]);
    answer.refused(&["--corners", "3 targets"]);
    let (_, answer) = calibrated("dlt2d", &plane_csv(&[]), &["--corners", "0,7,14,224"]);
    answer.refused(&["lie on a line"]);
}

#[test]
fn digitised_cube_is_no_calibration_and_has_no_camera_file() {
    let bench = Bench::new();
    let camera = "name = \"video\"\nprincipal_distance_mm = 10.0\n[sensor]\nwidth_px = 2000\nheight_px = 2000\npixel_um = 8.0\n";
    fs::write(bench.path("camera.toml"), camera).unwrap();
    let view = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../crates/adjustment/tests/data/cube/view1.csv"
    );
    // A camera file of a former run does not stay.
    fs::create_dir(bench.path("out")).unwrap();
    fs::write(bench.path("out/camera.toml"), camera).unwrap();
    let arguments = [
        "calibrate",
        "dlt3d",
        view,
        "--camera",
        "camera.toml",
        "--out",
        "out",
    ];
    let answer = bench.run(&arguments);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(
        answer.stdout.contains("are no calibration"),
        "{}",
        answer.stdout
    );
    for (text, words) in [
        (&answer.stdout, "the result is no usable camera"),
        (&answer.stderr, "no camera file is written, the reports are"),
        (
            &answer.stderr,
            "principal_point_mm[1] = 11.488514 is outside -8 to 8",
        ),
    ] {
        let plain = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(plain.contains(words), "{words} not in: {text}");
    }
    // Without a folder the end is the same.
    let answer = bench.run(&arguments[..5]);
    assert_eq!(answer.code, 1, "{}", answer.stderr);
    assert!(
        answer.stderr.contains("is no usable camera"),
        "{}",
        answer.stderr
    );
    assert!(!bench.path("out/camera.toml").exists());
    let summary = summary(&bench, "out/summary.json");
    let rms = summary["rms_point_px"].as_f64().unwrap();
    assert!((rms - 2.5734).abs() < 1e-4, "{rms}");
    let sigma = parameter(&summary, "principal_distance_mm").1 / 8e-3;
    assert!((sigma - 421.0).abs() < 5.0, "{sigma}");
}
