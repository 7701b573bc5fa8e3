//! Requests and records that cannot be met.

use std::fs;

use super::{export, flown};

#[test]
fn formats_with_one_camera_name_what_to_do_instead() {
    let bench = flown();
    for format in [
        "opencv",
        "ros",
        "kalibr",
        "pix4d",
        "micmac",
        "australis",
        "photomodeler",
    ] {
        bench.run(&export(format, "records.csv", &[])).refused(&[
            "--records",
            format,
            "host-sim correct",
            "--answer",
        ]);
    }
    for format in ["arcgis", "frames"] {
        bench
            .run(&["export", format, "--camera", "camera.toml", "--out", "out"])
            .refused(&[format, "--records"]);
    }
    bench
        .run(&export("arcgis", "records.csv", &["--model", "OPENCV"]))
        .refused(&["--model OPENCV", "arcgis"]);
    let records = |more: &[&str]| bench.run(&export("colmap", "records.csv", more));
    let both = ["--images", "map.csv", "--image-name", "{sequence}"];
    records(&both).refused(&["--images", "--image-name"]);
    records(&["--image-name", "a.tif"]).refused(&["--image-name", "no {sequence}"]);
    bench
        .run(&export("opensfm", "records.csv", &["--id", "x"]))
        .refused(&["--id"]);
    bench
        .run(&[
            "export",
            "colmap",
            "--camera",
            "camera.toml",
            "--out",
            "out",
            "--image-name",
            "{sequence}",
        ])
        .refused(&["--records"]);
}

#[test]
fn records_that_do_not_fit_are_refused() {
    let bench = flown();
    let text = fs::read_to_string(bench.path("records.csv")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let with = |changed: &str, words: &[&str]| {
        fs::write(bench.path("changed.csv"), changed).unwrap();
        bench.run(&export("opf", "changed.csv", &[])).refused(words);
    };
    let half = &text[..text.len() / 2];
    with(half, &["changed.csv"]);
    with("", &["changed.csv", "empty"]);
    let twice = [&lines[..], &lines[1..2]].concat().join("\n");
    with(&twice, &["changed.csv, line 7", "sequence 1 appears twice"]);
    with(
        &text.replace("principal_point_y_mm", "y"),
        &["principal_point_y_mm"],
    );
    let refused_alone = [lines[0], lines[3]].join("\n");
    with(&refused_alone, &["changed.csv", "no exposure among 1"]);
    let headings: Vec<&str> = lines[0].split(',').collect();
    let column = |name: &str| headings.iter().position(|one| *one == name).unwrap();
    let set = |name: &str, value: &str| {
        let mut cells: Vec<&str> = lines[2].split(',').collect();
        cells[column(name)] = value;
        let changed = cells.join(",");
        [&lines[..2], &[changed.as_str()], &lines[3..]]
            .concat()
            .join("\n")
    };
    with(
        &set("principal_point_y_mm", "NaN"),
        &["changed.csv, line 3", "principal_point_y_mm"],
    );
    with(
        &set("principal_point_y_mm", ""),
        &["changed.csv, line 3", "principal_point_y_mm", "missing"],
    );
    with(
        &set("calibration_crc32", "12345678"),
        &["changed.csv, line 3", "12345678", "another calibration"],
    );
    with(
        &set("centroid_unix_us", "18446744073709551615"),
        &["centroid_unix_us", "calendar"],
    );
    bench
        .run(&export("opf", "missing.csv", &[]))
        .refused(&["missing.csv", "cannot be read"]);
    // Another camera than the one that has flown.
    let other = include_str!("../../../scenarios/cameras/mission.toml");
    fs::write(bench.path("camera.toml"), other.replace("100.0", "100.1")).unwrap();
    bench.run(&export("opf", "records.csv", &[])).refused(&[
        "records.csv, line 2",
        "another calibration",
        "camera.toml",
    ]);
    assert!(!bench.path("opf").exists());
}

#[test]
fn inputs_are_not_replaced() {
    let bench = flown();
    fs::create_dir(bench.path("frames")).unwrap();
    fs::copy(bench.path("records.csv"), bench.path("frames/frames.csv")).unwrap();
    bench
        .run(&export("frames", "frames/frames.csv", &[]))
        .refused(&["frames.csv", "--out"]);
    let text = fs::read_to_string(bench.path("frames/frames.csv")).unwrap();
    assert!(text.starts_with("sequence,trigger_us"));
}
