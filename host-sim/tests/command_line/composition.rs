//! Cameras of several detectors: `scene`, `calibrate radiometry`, `calibrate rig`, `virtual`,
//! `stereo`, `dmz`.

mod refused;

use std::fmt::Write as _;
use std::fs;

use fmc_composition::scene::{Scene, SceneRequest};

use crate::command_line::support::Bench;

/// A bench with a small scene.
fn bench() -> Bench {
    let bench = Bench::new();
    let arguments = [
        "scene", "dmz", "--scale", "16", "--darks", "2", "--out", "scene",
    ];
    bench.run(&arguments).ok();
    bench
}

fn summary(bench: &Bench, path: &str) -> serde_json::Value {
    serde_json::from_slice(&fs::read(bench.path(path)).unwrap()).unwrap()
}

const RADIOMETRY: [&str; 7] = [
    "calibrate",
    "radiometry",
    "--rig",
    "scene/rig.toml",
    "--out",
    "rad",
    "scene",
];

const RIG: [&str; 8] = [
    "calibrate",
    "rig",
    "--rig",
    "scene/rig.toml",
    "--ties",
    "scene/ties.csv",
    "--out",
    "rig",
];

/// Checks the figures of a radiometry with levels, as printed and in its file.
fn states_the_figures_of_emva_1288(bench: &Bench, stdout: &str) {
    for name in [
        "PRNU1288, %",
        "DSNU1288, e-",
        "μ_e.sat",
        "σ_d",
        "LE, %",
        "DR, dB",
        "K, DN/e-",
    ] {
        assert!(stdout.contains(name), "{name}: {stdout}");
    }
    assert!(!stdout.contains("Not determined: linearity"), "{stdout}");
    let found = summary(bench, "rad/radiometry.json");
    for sub in found["sub"].as_array().unwrap() {
        let linearity = &sub[1]["linearity"];
        assert_eq!(linearity["sets"], 19, "{sub}");
        // Noise of a set's mean over 100,000 pixels: below 0.01 %.
        assert!(linearity["error_percent"].as_f64().unwrap() < 0.01, "{sub}");
        let electrons = sub[1]["temporal_dark_noise_e"].as_f64().unwrap();
        assert!((19.0..21.0).contains(&electrons), "{sub}");
    }
}

#[test]
fn scene_becomes_a_virtual_image_by_radiometry_and_rig() {
    let bench = bench();
    let answer = bench.run(&RADIOMETRY).ok();
    states_the_figures_of_emva_1288(&bench, &answer.stdout);
    let answer = bench.run(&[&RIG[..], &["scene/control.csv"]].concat()).ok();
    assert!(
        answer.stdout.contains("kept nominal: mean place"),
        "{}",
        answer.stdout
    );
    let found = summary(&bench, "rig/summary.json");
    assert!(
        (0.9..1.1).contains(&found["sigma0"].as_f64().unwrap()),
        "{found}"
    );
    assert_eq!(found["sub"].as_array().unwrap().len(), 6);
    let correlations = fs::read_to_string(bench.path("rig/correlations.csv")).unwrap();
    // Every two of 2 x 10 coefficients of six sub-images.
    assert_eq!(correlations.lines().count(), 1 + 6 * 190);
    let arguments = [
        "virtual",
        "--rig",
        "rig/rig.toml",
        "--radiometry",
        "rad",
        "--out",
        "out",
        "scene/8_10",
    ];
    bench.run(&arguments).ok();
    let found = summary(&bench, "out/summary.json");
    assert!(found["seam_step_px"].as_f64().unwrap() < 0.2, "{found}");
    assert!(found["content_percent"].as_f64().unwrap() > 97.0, "{found}");
    assert!(found["green"]["kept"].as_u64().unwrap() > 200, "{found}");
    for name in [
        "virtual.tif",
        "mask.tif",
        "labels.tif",
        "ties.csv",
        "report.html",
    ] {
        assert!(
            fs::metadata(bench.path(&format!("out/{name}")))
                .unwrap()
                .len()
                > 100,
            "{name}"
        );
    }
    // Its ties calibrate a rig.
    let ties = [
        "calibrate",
        "rig",
        "--rig",
        "scene/rig.toml",
        "--exposure",
        "8_10",
        "--ties",
        "out/ties.csv",
        "--out",
        "again",
        "scene/control.csv",
    ];
    bench.run(&ties).ok();
    // Shifts alone leave steps.
    let shifted = [
        "virtual",
        "--rig",
        "rig/rig.toml",
        "--order",
        "mosaic-first",
        "--out",
        "shifted",
        "scene/8_10",
    ];
    bench.run(&shifted).ok();
    let found = summary(&bench, "shifted/summary.json");
    assert!(found["seam_step_px"].as_f64().unwrap() > 0.4, "{found}");
}

/// Marks of both true virtual images, as `stereo` reads them.
fn marks_of_the_truth(request: SceneRequest) -> String {
    let scene = Scene::new(request);
    let mut text = "id,image,col_px,row_px,x_m,y_m,z_m\n".to_owned();
    for mark in &scene.marks {
        let [x, y, z] = mark.ground_m;
        for (number, exposure) in [("1", 0), ("2", 1)] {
            let [col, row] = scene.virtual_of_ground(exposure, mark.ground_m).unwrap();
            let size_px = [scene.rig.frame.width_px, scene.rig.frame.height_px];
            let [width, height] = size_px.map(|side| f64::from(u32::try_from(side).unwrap()));
            if (10.0..width - 10.0).contains(&col) && (10.0..height - 10.0).contains(&row) {
                writeln!(text, "{},{number},{col},{row},{x},{y},{z}", mark.id).unwrap();
            }
        }
    }
    text
}

#[test]
fn publication_is_repeated_within_its_limits_and_true_virtual_images_are_a_stereo_pair() {
    let bench = Bench::new();
    let answer = bench.run(&["dmz", "--scale", "16", "--seed", "3", "--out", "dmz"]);
    answer.ok();
    let found = summary(&bench, "dmz/summary.json");
    let checks = found.as_array().unwrap();
    assert!(checks.len() >= 34, "{found}");
    for check in checks {
        assert_eq!(check["passed"], true, "{check}");
        assert!(check["found"].as_f64().unwrap() > 0.0, "{check}");
    }
    let up_to_date = fs::read_to_string(bench.path("dmz/figure.svg")).unwrap()
        == include_str!("../../../docs/figures/dmz.svg");
    assert!(
        up_to_date,
        "docs/figures/dmz.svg is out of date: copy it from the folder of this dmz"
    );
    let marks = marks_of_the_truth(SceneRequest {
        scale: 16,
        seed: 3,
        ..SceneRequest::default()
    });
    fs::write(bench.path("marks.csv"), &marks).unwrap();
    let rig = [
        "stereo",
        "--rig",
        "dmz/scene/rig.toml",
        "--marks",
        "marks.csv",
        "--out",
        "stereo",
    ];
    let truth = "dmz/scene/truth";
    let images = [
        format!("{truth}/virtual_8_10.tif"),
        format!("{truth}/virtual_8_11.tif"),
    ];
    let pair = [&images[0][..], &images[1]];
    let answer = bench.run(&[&rig[..], &pair].concat()).ok();
    assert!(answer.stdout.contains("40: σ0"), "{}", answer.stdout);
    assert!(
        answer.stdout.contains("no check point"),
        "{}",
        answer.stdout
    );
    let found = summary(&bench, "stereo/summary.json");
    for layout in &found.as_array().unwrap()[..2] {
        let checked = layout["result"]["check_m"].as_array().unwrap();
        // Marks without noise: what is left is matching, and the control's σ that is stated.
        assert!(
            checked.iter().all(|m| m.as_f64().unwrap() < 0.05),
            "{layout}"
        );
    }
    let wrong = marks.replacen(",1,", ",3,", 1);
    fs::write(bench.path("marks.csv"), wrong).unwrap();
    bench
        .run(&[&rig[..], &pair].concat())
        .refused(&["marks.csv, line", "image = 3", "1, 2"]);
}
