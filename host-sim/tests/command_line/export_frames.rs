//! `export --records`: frames of a flight for other programs.

use std::collections::BTreeSet;
use std::fs;

use fmc_exchange::program::Program;
use serde_json::Value;

use crate::command_line::support::Bench;

/// The strong lens of the published cameras, flown from rest.
const IXM: &str = concat!(
    include_str!("../../cameras/phase-one-ixm-rs150f-50.toml"),
    "\n[fmc]\nstrategy = \"from-rest\"\n"
);

/// Files of each format, without export.json.
const FILES: [(&str, &[&str]); 7] = [
    ("colmap", &["cameras.txt", "images.txt", "points3D.txt"]),
    ("metashape", &["cameras.xml", "frames.py"]),
    (
        "opensfm",
        &["camera_models_overrides.json", "exif_overrides.json"],
    ),
    ("opf", &["calibrated_cameras.json", "camera_list.json"]),
    ("opentrackio", &["samples.jsonl"]),
    ("arcgis", &["cameras.csv", "frames.csv"]),
    ("frames", &["frames.csv"]),
];

/// Number of the trigger that is refused in [`flown`].
const REFUSED: u32 = 3;

/// Returns a bench with the records of a mission from rest: exposures 1, 2, 4 and 5, the first
/// without UTC.
fn flown() -> Bench {
    let camera = include_str!("../../scenarios/cameras/mission.toml");
    let bench = Bench::with(camera, b"");
    let scenario = include_str!("../../scenarios/mission.toml");
    let scenario = scenario.replace("cameras/mission.toml", "camera.toml");
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    bench.run(&[
        "mission",
        "--scenario",
        "scenario.toml",
        "--exposures",
        "5",
        "--out",
        "flown",
    ]);
    for name in ["records.csv", "records.json"] {
        fs::copy(bench.path("flown").join(name), bench.path(name)).unwrap();
    }
    refuse(&bench);
    bench
}

/// Makes the third trigger of both files one that was refused, as the camera writes it.
fn refuse(bench: &Bench) {
    let text = fs::read_to_string(bench.path("records.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let headings = reader.headers().unwrap().clone();
    let mut writer = csv::Writer::from_path(bench.path("records.csv")).unwrap();
    writer.write_record(&headings).unwrap();
    let kept = [
        "sequence",
        "trigger_us",
        "faults",
        "fault_codes",
        "flags",
        "calibration_crc32",
        "calibration_serial",
        "calibration_version",
        "calibration_storage",
    ];
    for row in reader.records().map(Result::unwrap) {
        let is_refused = row[0] == REFUSED.to_string();
        let cells = headings
            .iter()
            .zip(&row)
            .map(|(heading, cell)| match heading {
                _ if !is_refused || kept.contains(&heading) => cell,
                "outcome" => "refused",
                "reason" => "stall",
                _ => "",
            });
        writer.write_record(cells).unwrap();
    }
    writer.flush().unwrap();
    let mut tree = json(bench, "records.json");
    let row = &mut tree["records"][2];
    for (key, value) in row.as_object_mut().unwrap() {
        match key.as_str() {
            "outcome" => *value = "refused".into(),
            "reason" => *value = "stall".into(),
            key if kept.contains(&key) => {}
            _ => *value = Value::Null,
        }
    }
    fs::write(bench.path("records.json"), tree.to_string()).unwrap();
}

fn json(bench: &Bench, file: &str) -> Value {
    serde_json::from_slice(&fs::read(bench.path(file)).unwrap()).unwrap()
}

/// Returns the rows of a table by the names of its columns.
fn rows(bench: &Bench, file: &str) -> Vec<Vec<(String, String)>> {
    let mut reader = csv::Reader::from_path(bench.path(file)).unwrap();
    let headings = reader.headers().unwrap().clone();
    reader
        .records()
        .map(|row| {
            let row = row.unwrap();
            let cells = headings.iter().zip(&row);
            cells.map(|(a, b)| (a.to_owned(), b.to_owned())).collect()
        })
        .collect()
}

fn cell<'a>(row: &'a [(String, String)], name: &str) -> &'a str {
    let found = row.iter().find(|(heading, _)| heading == name);
    &found.unwrap_or_else(|| panic!("{name}")).1
}

fn export<'a>(format: &'a str, records: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let arguments = [
        "export",
        format,
        "--camera",
        "camera.toml",
        "--records",
        records,
        "--out",
        format,
    ];
    [&arguments, more].concat()
}

#[test]
fn formats_are_those_of_the_library() {
    let with_frames = FILES.map(|(format, _)| format);
    assert_eq!(with_frames, Program::WITH_FRAMES.map(Program::name));
}

#[test]
fn every_format_has_its_files_and_lists_refused_triggers() {
    let bench = flown();
    for (format, files) in FILES {
        let answer = bench.run(&export(format, "records.csv", &[])).ok();
        let found: BTreeSet<String> = fs::read_dir(bench.path(format))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        let expected = files.iter().chain(&["export.json"]);
        assert_eq!(found, expected.map(|name| (*name).to_owned()).collect());
        let statement = json(&bench, &format!("{format}/export.json"));
        let frames = &statement["frames"];
        assert_eq!(frames["exposures"], 4);
        assert_eq!(frames["refused"][0]["sequence"], REFUSED);
        assert_eq!(frames["refused"][0]["reason"], "stall");
        assert_eq!(frames["refused"].as_array().unwrap().len(), 1);
        assert_eq!(frames["without_utc"], 1);
        assert_eq!(frames["images"], "IMG_{sequence:05}.tif");
        assert_eq!(statement["files"], serde_json::json!(files));
        assert!(answer.stdout.contains("1: 3 (stall)"), "{}", answer.stdout);
        let widest = answer.stdout.lines().map(|line| line.chars().count()).max();
        assert!(widest.unwrap() <= 80, "{}", answer.stdout);
        // Refused triggers are never filled in.
        for name in files {
            let text = fs::read_to_string(bench.path(format).join(name)).unwrap();
            assert!(!text.contains("IMG_00003"), "{format}: {name}");
        }
    }
}

#[test]
fn json_and_csv_of_the_records_give_the_same_bytes() {
    let bench = flown();
    for (format, files) in FILES {
        bench.run(&export(format, "records.csv", &[])).ok();
        let read = |name: &&str| fs::read(bench.path(format).join(name)).unwrap();
        let of_csv: Vec<Vec<u8>> = files.iter().map(read).collect();
        bench.run(&export(format, "records.json", &[])).ok();
        let of_json: Vec<Vec<u8>> = files.iter().map(read).collect();
        assert!(of_csv == of_json, "{format}");
    }
}

#[test]
fn principal_point_and_times_are_those_of_the_records() {
    let bench = flown();
    for format in ["frames", "arcgis", "opentrackio", "opensfm"] {
        bench.run(&export(format, "records.csv", &[])).ok();
    }
    let records = rows(&bench, "records.csv");
    let records: Vec<_> = records
        .iter()
        .filter(|row| cell(row, "outcome") == "exposed")
        .collect();
    let frames = rows(&bench, "frames/frames.csv");
    let arcgis = rows(&bench, "arcgis/frames.csv");
    let samples = fs::read_to_string(bench.path("opentrackio/samples.jsonl")).unwrap();
    let samples: Vec<Value> = samples
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let exif = json(&bench, "opensfm/exif_overrides.json");
    assert_eq!(
        [records.len(), frames.len(), arcgis.len(), samples.len()],
        [4; 4]
    );
    for (((record, frame), table), sample) in
        records.into_iter().zip(&frames).zip(&arcgis).zip(&samples)
    {
        for name in [
            "sequence",
            "principal_point_x_mm",
            "principal_point_y_mm",
            "centroid_us",
            "centroid_unix_us",
            "utc_sigma_s",
            "enlargement",
            "centroid_offset_mm",
            "principal_point_sigma_mm",
            "principal_point_frame_sigma_mm",
            "principal_point_common_sigma_mm",
        ] {
            assert_eq!(cell(record, name), cell(frame, name), "{name}");
        }
        let number = |row: &[(String, String)], name: &str| cell(row, name).parse::<f64>().unwrap();
        let y_mm = number(record, "principal_point_y_mm");
        let row_px = number(frame, "principal_point_row_px");
        assert!((row_px - (4607.5 - y_mm / 8.75e-3)).abs() < 1e-5);
        let corner = number(frame, "principal_point_corner_y_px");
        assert!((corner - row_px - 0.5).abs() < 1e-9);
        assert!((number(table, "PrincipalY") - 1e3 * y_mm).abs() < 1e-5);
        let y_down = sample["lens"]["projectionOffset"]["y"].as_f64().unwrap();
        assert!((y_down + y_mm).abs() < 1e-9);
        let times = ["centroid_utc", "gps_week", "gps_seconds_of_week"].map(|one| cell(frame, one));
        let timestamp = &sample["timing"]["sampleTimestamp"];
        let of_image = &exif[cell(frame, "image")];
        if cell(record, "centroid_unix_us").is_empty() {
            // Never 0.
            assert_eq!(times, [""; 3]);
            assert_eq!(cell(table, "CentroidUTC"), "");
            assert!(timestamp.is_null() && of_image["capture_time"].is_null());
            continue;
        }
        let unix_us: u64 = cell(record, "centroid_unix_us").parse().unwrap();
        assert_eq!(cell(table, "CentroidUTC"), times[0]);
        assert!(times[0].starts_with("2026-") && times[0].ends_with('Z'));
        let week: u64 = times[1].parse().unwrap();
        let gps_us = week * 604_800_000_000 + times[2].replace('.', "").parse::<u64>().unwrap();
        assert_eq!(gps_us, unix_us - 315_964_800_000_000 + 18_000_000);
        let tai_us = timestamp["seconds"].as_u64().unwrap() * 1_000_000
            + timestamp["nanoseconds"].as_u64().unwrap() / 1000;
        assert_eq!(tai_us, unix_us + 37_000_000);
        let taken = of_image["capture_time"].as_f64().unwrap();
        assert!(
            (taken
                - 1e-6 * f64::from(u32::try_from(unix_us % 1_000_000).unwrap())
                - f64::from(u32::try_from(unix_us / 1_000_000).unwrap()))
            .abs()
                < 1e-6
        );
    }
    assert!(frames.iter().any(|row| cell(row, "gps_week").is_empty()));
}

#[test]
fn images_have_the_names_of_the_map_or_of_the_pattern() {
    let bench = flown();
    let map = "image,sequence,note\nb.tif,2,x\na.tif,1,y\nd.tif,4,\n\"e,f.tif\",5,\n";
    fs::write(bench.path("map.csv"), map).unwrap();
    bench
        .run(&export("frames", "records.csv", &["--images", "map.csv"]))
        .ok();
    let found = rows(&bench, "frames/frames.csv");
    let images: Vec<&str> = found.iter().map(|row| cell(row, "image")).collect();
    assert_eq!(images, ["a.tif", "b.tif", "d.tif", "e,f.tif"]);
    assert_eq!(
        json(&bench, "frames/export.json")["frames"]["images"],
        "map.csv"
    );
    let pattern = ["--image-name", "s1/{sequence}.iiq"];
    bench.run(&export("frames", "records.csv", &pattern)).ok();
    let found = rows(&bench, "frames/frames.csv");
    assert_eq!(cell(&found[3], "image"), "s1/5.iiq");
}

#[test]
fn gaps_doubles_and_refused_triggers_of_the_map_are_refused_by_line() {
    let bench = flown();
    let with = |map: &str, words: &[&str]| {
        fs::write(bench.path("map.csv"), map).unwrap();
        let arguments = export("colmap", "records.csv", &["--images", "map.csv"]);
        bench.run(&arguments).refused(words);
    };
    with(
        "sequence,image\n1,a\n2,b\n5,e\n",
        &["map.csv", "sequence", "4 is missing"],
    );
    with(
        "sequence,image\n1,a\n2,b\n3,c\n4,d\n5,e\n",
        &["map.csv, line 4", "sequence = 3", "refused trigger (stall)"],
    );
    with(
        "sequence,image\n1,a\n2,b\n4,d\n5,e\n77,f\n",
        &["map.csv, line 6", "sequence = 77", "no record"],
    );
    with("sequence,image\n1,a\n1,b\n", &["map.csv, line 3", "twice"]);
    with("sequence,image\n1,a\n2,a\n", &["map.csv, line 3", "image"]);
    with("sequence,name\n1,a\n", &["map.csv, line 1", "column image"]);
    with(
        "sequence,image\n1,\"a\nb\"\n2,b\n4,d\n5,e\n",
        &["map.csv, line 2", "control character"],
    );
    assert!(!bench.path("colmap").exists());
}

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
    let other = include_str!("../../scenarios/cameras/mission.toml");
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

/// Writes the records of one exposure, as `frame` computes it.
fn one_record(bench: &Bench, more: &[&str]) {
    let arguments = [
        "frame",
        "--camera",
        "camera.toml",
        "--vh",
        "0.17",
        "--exposure",
        "1/100",
        "--json",
    ];
    let answer = bench.run(&[&arguments, more].concat()).ok();
    let frame: Value = serde_json::from_str(&answer.stdout).unwrap();
    let export = [
        "export",
        "colmap",
        "--camera",
        "camera.toml",
        "--out",
        "rest",
    ];
    bench.run(&export).ok();
    let crc = json(bench, "rest/export.json")["calibration_crc32"].clone();
    let [x, y] = [0, 1].map(|axis| frame["principal_point_mm"][axis].clone());
    let mut record = serde_json::json!({
        "sequence": 1, "trigger_us": 0, "outcome": "exposed", "opened_us": 0, "closed_us": 10_000,
        "centroid_us": 5000, "principal_point_x_mm": x, "principal_point_y_mm": y,
        "principal_point_frame_sigma_mm": 1e-5, "principal_point_common_sigma_mm": 0,
        "focus_shift_mm": frame["focus_shift_um"].as_f64().unwrap() / 1000.0,
        "focus_convention": "A", "centroid_after_opening_s": frame["centroid_time_s"],
        "variance_mm2": frame["travel_variance_mm2"], "third_moment_mm3": 0,
        "fourth_moment_mm4": 0, "compensated_vh_per_s": frame["vh_per_s"], "faults": [],
        "flags": [], "fault_codes": "", "calibration_crc32": crc,
    });
    for same in [
        "exposure_s",
        "principal_distance_mm",
        "enlargement",
        "model",
        "kernel",
        "left_out_nm",
        "opening_offset_mm",
        "travel_mm",
        "centroid_offset_mm",
    ] {
        record[same] = frame[same].clone();
    }
    for unknown in [
        "reason",
        "centroid_unix_us",
        "utc_sigma_s",
        "principal_point_sigma_mm",
        "planned_opening_mm",
        "planned_travel_mm",
        "vh_per_s",
        "vh_sigma_per_s",
        "vh_age_s",
        "vh_source",
        "vh_extrapolated",
        "predicted_smear_um",
        "predicted_smear_px",
        "calibration_serial",
        "calibration_version",
        "calibration_storage",
    ] {
        record[unknown] = Value::Null;
    }
    let file = serde_json::json!({ "records": [record] });
    fs::write(bench.path("records.json"), file.to_string()).unwrap();
}

#[test]
fn cost_of_one_camera_is_stated_and_the_way_is_advised() {
    let bench = Bench::with(IXM, b"");
    one_record(
        &bench,
        &["--opening-offset-mm", "0.145", "--focus-shift-um", "10"],
    );
    let answer = bench.run(&export("colmap", "records.json", &[])).ok();
    let statement = json(&bench, "colmap/export.json");
    let frames = &statement["frames"];
    assert!((frames["largest_offset_um"].as_f64().unwrap() - 188.6655).abs() < 1e-3);
    assert!((frames["largest_offset_px"].as_f64().unwrap() - 50.177).abs() < 1e-3);
    assert!((frames["largest_enlargement"].as_f64().unwrap() - 1.9466e-4).abs() < 1e-8);
    assert_eq!(frames["one_camera_is_enough"], false);
    assert!(frames["way"].as_str().unwrap().contains("camera per image"));
    assert!(
        answer.stdout.contains("189 µm (50.1770 px), sequence 1"),
        "{}",
        answer.stdout
    );
    let residual = statement["residual_max_um"].as_f64().unwrap();
    let at_rest = json(&bench, "rest/export.json")["residual_max_um"].clone();
    assert!(residual <= at_rest.as_f64().unwrap() + 5e-3);
    let cameras = fs::read_to_string(bench.path("colmap/cameras.txt")).unwrap();
    assert!(
        cameras.contains(" 7117.5319") && cameras.contains(" 5282.17938"),
        "{cameras}"
    );

    one_record(&bench, &["--opening-offset-mm", "-0.04366552"]);
    let answer = bench.run(&export("colmap", "records.json", &[])).ok();
    let frames = &json(&bench, "colmap/export.json")["frames"];
    assert_eq!(frames["one_camera_is_enough"], true);
    assert!(
        answer.stdout.contains("one camera for all frames"),
        "{}",
        answer.stdout
    );
    let limit = export("colmap", "records.json", &["--max-residual-um", "0.1"]);
    bench.run(&limit).failed(1, &["0.19", "--max-residual-um"]);
}
