//! `export --records`: frames of a flight for other programs.

mod formats;
mod images;
mod one_camera;
mod refused;

use std::fs;

use serde_json::Value;

use crate::command_line::support::Bench;

/// The strong lens of the published cameras, flown from rest.
const IXM: &str = concat!(
    include_str!("../../../cameras/phase-one-ixm-rs150f-50.toml"),
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
    let camera = include_str!("../../../scenarios/cameras/mission.toml");
    let bench = Bench::with(camera, b"");
    let scenario = include_str!("../../../scenarios/mission.toml");
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
        "boot",
        "flight",
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
