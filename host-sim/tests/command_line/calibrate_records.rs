//! `calibrate bundle --records` on a simulated block.

use std::fs;

use serde_json::Value;

use crate::command_line::calibration_files::assert_certified;
use crate::command_line::flight_block::{Block, RunUp};
use crate::command_line::support::{Answer, Bench};

const FROM_REST: Block = Block {
    run_up: RunUp::FromRest,
    seed: 1,
    fault_mm: 0.0,
    at_trigger: false,
    scale: 0.0,
};

fn run(bench: &Bench, more: &[&str]) -> Answer {
    estimating("x0,y0", bench, more)
}

fn estimating(names: &str, bench: &Bench, more: &[&str]) -> Answer {
    let arguments = [
        "calibrate",
        "bundle",
        "image_points.csv",
        "--points",
        "points.csv",
        "--images",
        "images.csv",
        "--camera",
        "camera.toml",
        "--estimate",
        names,
        "--records",
        "records.csv",
        "--out",
        "out",
    ];
    bench.run(&[&arguments, more].concat())
}

fn summary(bench: &Bench) -> Value {
    serde_json::from_slice(&fs::read(bench.path("out/summary.json")).unwrap()).unwrap()
}

fn along_m(summary: &Value, bundle: &str) -> f64 {
    summary[bundle]["check_points"][0].as_f64().unwrap()
}

fn suspects(summary: &Value) -> Vec<String> {
    let list = summary["suspect_records"].as_array().unwrap();
    list.iter()
        .map(|one| one["image"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn records_from_rest_in_wind_move_the_ground_back_by_18_cm() {
    let mut doubted = 0;
    for seed in 1..=4 {
        let bench = Block { seed, ..FROM_REST }.bench();
        let answer = run(&bench, &[]).ok();
        let summary = summary(&bench);
        // By hand: (63.5 - 37.7 µm)/2·700/50 = 18.0 cm.
        let fixed = along_m(&summary, "static_bundle");
        assert!((fixed - 0.18).abs() < 0.03, "{fixed}");
        let with = along_m(&summary, "records");
        assert!(with <= 0.02, "{with}");
        // The static bundle does not show it: 5 % limits of some thousand redundant observations.
        for sigma0 in [&summary["static_bundle"]["sigma0"], &summary["sigma0"]] {
            let sigma0 = sigma0.as_f64().unwrap();
            assert!((sigma0 - 1.0).abs() < 0.03, "{sigma0}");
        }
        assert_eq!(summary["records"]["tested"], 40);
        assert!(
            answer.stdout.contains("Records of the flight") && answer.stdout.contains("static"),
            "{}",
            answer.stdout
        );
        assert!(
            answer.stderr.contains("records of the wrong sign"),
            "{}",
            answer.stderr
        );
        doubted += usize::from(!suspects(&summary).is_empty());
    }
    assert_eq!(doubted, 0);
}

#[test]
fn certificate_shows_the_static_bundle_beside_it() {
    let bench = FROM_REST.bench();
    estimating("x0,y0,k1,p1", &bench, &[]).ok();
    assert_certified(&bench, "out");
    let page = fs::read_to_string(bench.path("out/certificate.html")).unwrap();
    for words in [
        "Records of the flight",
        "with records",
        "wrong sign",
        "Test of every record",
        "Object points with records and in the static bundle",
    ] {
        assert!(page.contains(words), "{words}");
    }
    for name in ["record-tests.svg", "static-bundle.svg"] {
        let svg = fs::read_to_string(bench.path(&format!("out/{name}"))).unwrap();
        assert!(
            svg.contains("static") && svg.contains("with records"),
            "{name}"
        );
        // Circles of 10 pixels stand around records in doubt.
        assert!(!svg.contains("r=\"10\""), "{name}");
    }
}

#[test]
fn centred_exposures_need_no_records() {
    let block = Block {
        run_up: RunUp::Centred,
        ..FROM_REST
    };
    let bench = block.bench();
    let answer = run(&bench, &[]).ok();
    let summary = summary(&bench);
    let difference = along_m(&summary, "static_bundle") - along_m(&summary, "records");
    assert!(difference.abs() < 1e-3, "{difference}");
    assert!(
        answer.stderr.contains("they buy nothing in this flight"),
        "{}",
        answer.stderr
    );
}

#[test]
fn wrong_record_of_one_frame_is_named_in_every_flight_and_no_other() {
    for seed in 1..=4 {
        let bench = Block {
            fault_mm: 0.040,
            seed,
            ..FROM_REST
        }
        .bench();
        let answer = run(&bench, &[]).ok();
        let summary = summary(&bench);
        assert_eq!(suspects(&summary), ["18"], "seed {seed}");
        let value = summary["suspect_records"][0]["test_value"]
            .as_f64()
            .unwrap();
        // 14 µm are found at 4.13: 40 µm at 11.8, three of its σ on either side.
        assert!((8.8..14.8).contains(&value), "seed {seed}: {value}");
        let words = "the record of image 18 is in doubt";
        assert!(answer.stderr.contains(words), "{}", answer.stderr);
        let figure = fs::read_to_string(bench.path("out/record-tests.svg")).unwrap();
        // Values of the static bundle beyond the limit have circles in their own colour.
        let circles = figure.lines().filter(|line| line.contains("r=\"10\""));
        let of_records = circles.filter(|line| line.contains("#0072B2")).count();
        assert_eq!(of_records, 1, "seed {seed}");
    }
}

#[test]
fn strips_along_one_line_do_not_show_the_wrong_sign() {
    let bench = FROM_REST.bench();
    let camera = fs::read_to_string(bench.path("camera.toml")).unwrap();
    let turned = camera.replace("[fmc]\n", "[fmc]\naxis = \"-y\"\n");
    assert_ne!(turned, camera);
    fs::write(bench.path("camera.toml"), turned).unwrap();
    let mut records = fs::read_to_string(bench.path("records.csv")).unwrap();
    for line in 2..=41 {
        let row = records.lines().nth(line - 1).unwrap();
        let offset: f64 = row.split(',').nth(7).unwrap().parse().unwrap();
        records = with_field(&records, line, 6, &(-0.01 - offset).to_string());
    }
    fs::write(bench.path("records.csv"), records).unwrap();
    let answer = run(&bench, &[]).ok();
    let summary = summary(&bench);
    // Twice the 18.0 cm of no records at all.
    let along = along_m(&summary, "records");
    assert!((along - 0.36).abs() < 0.03, "{along}");
    let sigma0 = summary["sigma0"].as_f64().unwrap();
    assert!((sigma0 - 1.0).abs() < 0.03, "{sigma0}");
    assert_eq!(suspects(&summary), [""; 0]);
    assert!(
        answer.stderr.contains("records of the wrong sign"),
        "{}",
        answer.stderr
    );
}

#[test]
fn positions_at_the_triggers_are_moved_to_the_centroids() {
    let at_trigger = Block {
        at_trigger: true,
        ..FROM_REST
    }
    .bench();
    run(&at_trigger, &["--positions-at-trigger"]).ok();
    let at_centroid = FROM_REST.bench();
    run(&at_centroid, &[]).ok();
    let [moved, stated] = [&at_trigger, &at_centroid].map(summary);
    let difference = along_m(&moved, "records") - along_m(&stated, "records");
    assert!(difference.abs() < 1e-6, "{difference}");
    // 13 and 11 ms at 90 and 60 m/s, to and fro: 1.18 m and 0.66 m, 0.26 m of it alike.
    run(&at_trigger, &[]).ok();
    assert!(along_m(&summary(&at_trigger), "records") > 0.1);
}

/// Runs on a changed file, which must be refused with all words.
fn refused(name: &str, change: impl Fn(&str) -> String, more: &[&str], words: &[&str]) {
    let bench = FROM_REST.bench();
    let text = fs::read_to_string(bench.path(name)).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed);
    fs::write(bench.path(name), changed).unwrap();
    run(&bench, more).refused(words);
    assert!(!bench.path("out").exists());
}

/// Returns the text with a field of a line, both counted from 1, replaced.
fn with_field(text: &str, line: usize, field: usize, value: &str) -> String {
    let lines = text.lines().enumerate().map(|(number, row)| {
        if number + 1 != line {
            return row.to_owned();
        }
        let mut fields: Vec<&str> = row.split(',').collect();
        fields[field - 1] = value;
        fields.join(",")
    });
    lines.map(|row| row + "\n").collect()
}

#[test]
fn records_that_do_not_belong_to_the_images_are_refused() {
    let at =
        |line, field, value: &'static str| move |text: &str| with_field(text, line, field, value);
    let records = "records.csv";
    refused(
        records,
        at(5, 1, "4711"),
        &[],
        &[
            "records.csv, line 5",
            "sequence = 4711",
            "allowed",
            "another flight",
        ],
    );
    refused(
        records,
        at(5, 1, "3"),
        &[],
        &["records.csv, lines 4 and 5", "sequence = 3 appears twice"],
    );
    refused(
        records,
        at(5, 1, "x"),
        &[],
        &["records.csv, line 5", "sequence = \"x\"", "0 to 4294967295"],
    );
    let without = |text: &str| {
        let rows = text.lines().filter(|row| !row.starts_with("18,"));
        rows.map(|row| row.to_owned() + "\n").collect()
    };
    refused(
        records,
        without,
        &[],
        &[
            "image_points.csv, line",
            "image 18 has no record in records.csv",
        ],
    );
    refused(
        records,
        at(5, 3, "refused"),
        &[],
        &[
            "records.csv, line 5",
            "outcome of sequence = 4 is refused",
            "allowed: exposed",
        ],
    );
    refused(
        "image_points.csv",
        |text| text.replace("\n18,", "\nA18,"),
        &[],
        &[
            "image_points.csv, line",
            "image A18 is no number",
            "0 to 4294967295",
        ],
    );
}

#[test]
fn values_that_no_record_of_this_camera_has_are_refused() {
    let change = |field: usize, value: &'static str, words: &[&str]| {
        let change = |text: &str| with_field(text, 5, field, value);
        refused(
            "records.csv",
            change,
            &[],
            &[&["records.csv, line 5"], words].concat(),
        );
    };
    change(3, "lost", &["outcome = \"lost\"", "exposed, refused"]);
    change(
        5,
        "0.03",
        &["principal_point_x_mm = 0.03", "contradicts", "0.020000"],
    );
    change(
        6,
        "-0.01",
        &["principal_point_y_mm = -0.01", "contradicts", "0.053520"],
    );
    change(
        7,
        "-0.001",
        &["principal_point_sigma_mm = -0.001", "0.000 to 1.000 mm"],
    );
    change(7, "NaN", &["principal_point_sigma_mm = \"NaN\"", "finite"]);
    change(
        8,
        "0.7",
        &["centroid_offset_mm = 0.7", "-0.500 to 0.500 mm"],
    );
    change(8, "", &["centroid_offset_mm = \"\"", "finite"]);
    change(9, "0.6", &["focus_shift_mm = 0.6", "-0.500 to 0.500 mm"]);
    refused(
        "records.csv",
        |text| text.replace("focus_shift_mm", "focus"),
        &[],
        &["records.csv, line 1", "focus_shift_mm is missing"],
    );
    refused(
        "records.csv",
        |text| text.lines().next().unwrap().to_owned() + "\n",
        &[],
        &["records.csv", "no rows"],
    );
}

#[test]
fn positions_at_the_triggers_need_times_and_velocities() {
    refused(
        "records.csv",
        |text| with_field(text, 5, 4, ""),
        &["--positions-at-trigger"],
        &["records.csv, line 5", "centroid_us of frame 4"],
    );
    refused(
        "images.csv",
        |text| text.replace("vx_m_s,vy_m_s,vz_m_s", "a,b,c"),
        &["--positions-at-trigger"],
        &["images.csv, line 2", "no velocity"],
    );
}

#[test]
fn scale_of_the_stage_is_found_and_stays_out_of_the_camera_file() {
    let bench = Block {
        scale: 0.5,
        ..FROM_REST
    }
    .bench();
    let more = ["--prior", "stage_axis_angle=0.01,run_out=0.001"];
    let names = "stage_scale,stage_axis_angle,run_out";
    let answer = estimating(names, &bench, &more).ok();
    let summary = summary(&bench);
    let parameter = |name: &str| {
        let list = summary["parameters"].as_array().unwrap();
        list.iter().find(|one| one["name"] == name).unwrap().clone()
    };
    let scale = parameter("stage_scale");
    let [value, sigma] = ["value", "sigma"].map(|key| scale[key].as_f64().unwrap());
    assert!((value - 0.5).abs() < 3.0 * sigma, "{value} ± {sigma}");
    assert!((0.005..0.05).contains(&sigma), "{sigma}");
    assert!(scale.get("prior_sigma").is_none(), "{scale}");
    assert_eq!(parameter("stage_axis_angle_rad")["prior_sigma"], 0.01);
    assert_eq!(parameter("run_out_mm_per_mm")["prior_sigma"], 0.001);
    for words in [
        "the observations say nothing about run_out_mm_per_mm",
        "do not go into the camera file",
    ] {
        assert!(answer.stderr.contains(words), "{words}: {}", answer.stderr);
    }
    // The static bundle has no stage, and the camera file keeps its own.
    assert!(summary["static_bundle"]["sigma0"].is_number());
    let [before, after] = ["camera.toml", "out/camera.toml"].map(|name| {
        let text = fs::read_to_string(bench.path(name)).unwrap();
        let stage = text.split("[fmc]").nth(1).unwrap();
        stage.split("\n[").next().unwrap().trim().to_owned()
    });
    assert_eq!(before, after);
}

#[test]
fn stage_as_an_unknown_needs_records_and_a_sigma_above_zero() {
    let bench = FROM_REST.bench();
    let refused = |more: &[&str], words: &[&str]| {
        estimating("x0,stage_scale", &bench, more).refused(words);
        assert!(!bench.path("out").exists());
    };
    for sigma in ["0", "-0.1"] {
        let prior = format!("stage_scale={sigma}");
        refused(
            &["--prior", &prior],
            &["stage_scale", "greater than 0", sigma],
        );
    }
    refused(
        &["--prior", "run_out=0.1"],
        &[
            "--prior",
            "run_out_mm_per_mm is not estimated",
            "--estimate",
        ],
    );
    refused(
        &["--prior", "stage=0.1"],
        &["stage is none of", "stage_scale, stage_axis_angle, run_out"],
    );
    let arguments = [
        "calibrate",
        "bundle",
        "image_points.csv",
        "--points",
        "points.csv",
        "--images",
        "images.csv",
        "--camera",
        "camera.toml",
        "--estimate",
        "run_out",
        "--out",
        "out",
    ];
    let words = [
        "run_out_mm_per_mm needs",
        "--records",
        "no image has a place",
    ];
    bench.run(&arguments).refused(&words);
    assert!(!bench.path("out").exists());
}
