//! Cameras of several detectors: `scene`, `calibrate radiometry`, `calibrate rig`, `virtual`,
//! `stereo`, `dmz`.

use std::fmt::Write as _;
use std::fs;

use fmc_composition::scene::{Scene, SceneRequest};

use crate::command_line::support::Bench;

/// A bench with a small scene.
fn bench() -> Bench {
    let bench = Bench::new();
    let arguments = [
        "scene", "dmz", "--scale", "16", "--darks", "1", "--out", "scene",
    ];
    bench.run(&arguments).ok();
    bench
}

fn summary(bench: &Bench, path: &str) -> serde_json::Value {
    serde_json::from_slice(&fs::read(bench.path(path)).unwrap()).unwrap()
}

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

/// Replaces the file by what a change makes of its text.
fn change(bench: &Bench, path: &str, change: impl Fn(&str) -> String) {
    let text = fs::read_to_string(bench.path(path)).unwrap();
    fs::write(bench.path(path), change(&text)).unwrap();
}

#[test]
fn scene_becomes_a_virtual_image_by_radiometry_and_rig() {
    let bench = bench();
    let radiometry = [
        "calibrate",
        "radiometry",
        "--rig",
        "scene/rig.toml",
        "--out",
        "rad",
        "scene",
    ];
    let answer = bench.run(&radiometry).ok();
    assert!(answer.stdout.contains("PRNU"), "{}", answer.stdout);
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

#[test]
fn control_and_ties_that_are_wrong_are_named() {
    let bench = bench();
    let control = fs::read_to_string(bench.path("scene/control.csv")).unwrap();
    let rows: Vec<&str> = control.lines().collect();
    let refused = |text: &str, words: &[&str]| {
        fs::write(bench.path("wrong.csv"), text).unwrap();
        bench
            .run(&[&RIG[..], &["wrong.csv"]].concat())
            .refused(words);
        assert!(!bench.path("rig").exists(), "nothing is written");
    };
    let first: Vec<&str> = rows[1].split(',').collect();
    let with = |column: usize, value: &str| {
        let mut cells = first.clone();
        cells[column] = value;
        control.replacen(rows[1], &cells.join(","), 1)
    };
    refused(
        &with(3, "9999"),
        &["wrong.csv, line 2", "outside sub-image", "allowed"],
    );
    let decimal = format!("{}", 10.0 * first[6].parse::<f64>().unwrap() + 700.0);
    refused(
        &with(6, &decimal),
        &["wrong.csv, line 2", first[0], "px from where"],
    );
    refused(&format!("{control}{}\n", rows[1]), &["appears twice"]);
    refused(&with(2, "7"), &["image = 7", "allowed: 1, 2, 3, 4, 5, 6"]);
    refused(&with(5, "nan"), &["x_m"]);
    refused(rows[0], &["no control point"]);
    change(&bench, "scene/ties.csv", |text| {
        let mut lines: Vec<&str> = text.lines().collect();
        lines.remove(2);
        lines.join("\n")
    });
    refused(&control, &["ties.csv, line 2", "in one image only"]);
}

#[test]
fn images_that_are_missing_or_say_nothing_are_named() {
    let bench = bench();
    bench.run(&[&RIG[..], &["scene/control.csv"]].concat()).ok();
    let virtual_image = [
        "virtual",
        "--rig",
        "rig/rig.toml",
        "--out",
        "out",
        "scene/8_10",
    ];
    let nominal = [
        "virtual",
        "--rig",
        "scene/rig.toml",
        "--out",
        "out",
        "scene/8_10",
    ];
    bench.run(&nominal).refused(&["rig.toml", "no polynomial"]);
    let green = bench.path("scene/8_10/green.tif");
    let kept = fs::read(&green).unwrap();
    // Of the header of this writer, the pixels stand behind the first 8 bytes.
    let mut flat = kept.clone();
    let end = flat.len() - 1000;
    flat[8..end].fill(30);
    fs::write(&green, &flat).unwrap();
    bench
        .run(&virtual_image)
        .refused(&["green.tif", "do not match"]);
    fs::write(&green, &kept[..400]).unwrap();
    bench.run(&virtual_image).refused(&["green.tif"]);
    fs::write(&green, &kept).unwrap();
    fs::copy(
        bench.path("scene/8_10/green.tif"),
        bench.path("scene/8_10/4.tif"),
    )
    .unwrap();
    bench
        .run(&virtual_image)
        .refused(&["4.tif", "allowed: 256 x 448 px"]);
    fs::remove_file(bench.path("scene/8_10/4.tif")).unwrap();
    bench
        .run(&virtual_image)
        .refused(&["4.tif", "cannot be read"]);
    fs::remove_file(bench.path("scene/darks/3_00.tif")).unwrap();
    let radiometry = [
        "calibrate",
        "radiometry",
        "--rig",
        "scene/rig.toml",
        "--out",
        "rad",
        "scene",
    ];
    bench.run(&radiometry).refused(&["darks", "no 3_NN.tif"]);
    assert!(!bench.path("out").exists() && !bench.path("rad").exists());
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
    assert!(checks.len() >= 26, "{found}");
    for check in checks {
        assert_eq!(check["passed"], true, "{check}");
        assert!(check["found"].as_f64().unwrap() > 0.0, "{check}");
    }
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
