//! Files of each format, and the numbers in them.

use std::collections::BTreeSet;
use std::fs;

use fmc_exchange::program::Program;
use serde_json::Value;

use super::{FILES, REFUSED, cell, export, flown, json, rows};

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
