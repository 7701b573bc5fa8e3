//! The schema of the link and its test vectors, made from the types and held to them.

mod fields;
mod types;
mod vectors;

use std::fmt::Write as _;
use std::fs;

use fmc_camera::io::link::{
    CALIBRATION_CAPACITY, LONGEST_PACKET, LONGEST_PAYLOAD, LONGEST_READING, MAX_GRID_PART,
    MAX_OBSERVATIONS, MAX_PART, MAX_POINTS, PROTOCOL_VERSION,
};
use serde_json::{Value, json};

/// The schema: types and numbers of everything that a message consists of.
const SCHEMA: &str = "docs/link-schema.json";

/// Messages with their bytes.
const VECTORS: &str = "docs/link-vectors.json";

/// Returns the schema as its file has it.
fn schema() -> String {
    let types = types::registry();
    let notes = fields::notes(&types);
    let schema = json!({
        "protocol_version": PROTOCOL_VERSION,
        "header": "Header",
        "request": "Request",
        "answer": "Answer",
        "parameters": "CameraParameters",
        "behind_parameters": [
            { "TYPENAME": "GridChecksums" },
            { "SEQ": { "TYPENAME": "FocusRow" } },
        ],
        "limits": {
            "points": MAX_POINTS,
            "observations": MAX_OBSERVATIONS,
            "parameter_bytes": CALIBRATION_CAPACITY,
            "part_bytes": MAX_PART,
            "grid_part_bytes": MAX_GRID_PART,
            "payload_bytes": LONGEST_PAYLOAD,
            "packet_bytes": LONGEST_PACKET,
            "reading_packet_bytes": LONGEST_READING,
        },
        "types": types,
        "notes": notes,
    });
    serde_json::to_string_pretty(&schema).unwrap() + "\n"
}

/// Returns the vectors as their file has them: one in a line.
fn vectors() -> String {
    let vectors = vectors::vectors(&types::registry());
    let mut text = format!("{{\"protocol_version\": {PROTOCOL_VERSION}, \"vectors\": [\n");
    let lines: Vec<String> = vectors.iter().map(Value::to_string).collect();
    writeln!(text, "{}\n]}}", lines.join(",\n")).unwrap();
    text
}

/// Compares a file with what the types make, or writes it where `FMC_WRITE_SCHEMA` is set.
fn compare(path: &str, made: &str) {
    if std::env::var_os("FMC_WRITE_SCHEMA").is_some() {
        fs::write(path, made).unwrap();
    }
    let file = fs::read_to_string(path).unwrap();
    let mut lines = file.lines().zip(made.lines()).enumerate();
    if let Some((index, (old, new))) = lines.find(|(_, (old, new))| old != new) {
        panic!(
            "{path}:{}: {old:?} is {new:?} by the types. Raise PROTOCOL_VERSION, and write both \
             files: FMC_WRITE_SCHEMA=1 cargo test -p fmc-camera --features store,estimation \
             --test library link::schema",
            index + 1
        );
    }
    assert_eq!(file.len(), made.len(), "{path}");
}

#[test]
fn schema_of_the_link_is_that_of_its_types() {
    compare(SCHEMA, &schema());
}

#[test]
fn vectors_of_the_link_are_the_bytes_of_its_types() {
    compare(VECTORS, &vectors());
}

#[test]
fn fields_with_a_unit_have_it_in_the_schema() {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    for (field, unit) in [
        ("Exposure.vh_per_s", "1/s"),
        ("Status.following_rms_um", "µm"),
        ("Status.offset_mm", "mm"),
        ("ClockDrift.drift_ppm", "ppm"),
        ("Request.BeginLoad.length", "bytes"),
        ("Brown.k2", "mm⁻⁴"),
        ("FocusRow.temperature_c", "°C"),
        ("FocusRow.focus_shift_um", "µm"),
        ("ExposedFrame.planned_travel_mm", "mm"),
    ] {
        let found = schema["notes"][field]["unit"].as_str().unwrap_or_default();
        assert_eq!(found, unit, "{field}");
    }
}
