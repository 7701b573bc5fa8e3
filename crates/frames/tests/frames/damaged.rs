//! Records that are damaged, or another camera's.

use fmc_camera_file::CameraFile;
use fmc_frames::FrameCamera;

use crate::support::{IXM, camera, csv, flight, json, read};

/// Returns the records with a column of the second replaced.
fn with(text: &str, column: &str, value: &str) -> String {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let place = header.iter().position(|name| name == column).unwrap();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&header).unwrap();
    for (index, row) in reader.records().map(Result::unwrap).enumerate() {
        let cells = row.iter().enumerate();
        writer
            .write_record(cells.map(|(cell, text)| match (index, cell) {
                (1, cell) if cell == place => value,
                _ => text,
            }))
            .unwrap();
    }
    String::from_utf8(writer.into_inner().unwrap()).unwrap()
}

#[test]
fn error_of_a_type_names_the_line_of_an_editor_whatever_the_ends_of_lines() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    let text = with(&csv(&written[..3]), "centroid_offset_mm", "x");
    for ending in ["\n", "\r\n"] {
        let error = read(&text.replace('\n', ending), &camera).unwrap_err();
        assert_eq!(
            error.to_string(),
            "records, line 3: centroid_offset_mm = \"x\": invalid float literal"
        );
    }
}

#[test]
fn wrong_values_are_refused_by_line_column_value_and_range() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    let text = csv(&written[..3]);
    for (column, value, expected) in [
        ("sequence", "1", "sequence 1 appears twice"),
        (
            "sequence",
            "-1",
            "sequence = \"-1\": invalid digit found in string",
        ),
        (
            "sequence",
            "",
            "sequence = \"\": cannot parse integer from empty string",
        ),
        (
            "outcome",
            "done",
            "outcome = done: must be exposed or refused",
        ),
        (
            "outcome",
            "refused",
            "reason of a refused trigger is missing",
        ),
        (
            "principal_point_y_mm",
            "NaN",
            "principal_point_y_mm = NaN: must be a finite number",
        ),
        (
            "principal_point_y_mm",
            "0.5",
            "principal_point_y_mm = 0.5: must be ",
        ),
        (
            "principal_distance_mm",
            "50",
            "principal_distance_mm = 50: must be 51.3712",
        ),
        ("travel_mm", "", "travel_mm of an exposure is missing"),
        (
            "travel_mm",
            "inf",
            "travel_mm = inf: must be a finite number",
        ),
        ("travel_mm", "9", "travel_mm = 9 is outside "),
        (
            "opening_offset_mm",
            "-7.5",
            "opening_offset_mm = -7.5 is outside -2 to 2",
        ),
        (
            "centroid_offset_mm",
            "x",
            "centroid_offset_mm = \"x\": invalid float literal",
        ),
        (
            "variance_mm2",
            "-1",
            "variance_mm2 = -1: must be at least 0",
        ),
        (
            "focus_shift_mm",
            "0.7",
            "focus_shift_mm = 0.7: must be -0.51",
        ),
        ("focus_convention", "B", "focus_convention = B: must be A"),
        ("enlargement", "0.01", "enlargement = 0.01: must be "),
        (
            "model",
            "linear",
            "model = linear: must be exact, fitted or static",
        ),
        ("kernel", "", "kernel = : must be short or full"),
        ("centroid_us", "", "centroid_us of an exposure is missing"),
        (
            "principal_point_frame_sigma_mm",
            "-1e-5",
            "principal_point_frame_sigma_mm = -0.00001: must be at least 0",
        ),
        (
            "calibration_crc32",
            "beef",
            "calibration_crc32 = beef: must be eight hexadecimal digits",
        ),
        (
            "calibration_crc32",
            "deadbeef",
            "calibration_crc32 = deadbeef: a record of another calibration than camera.toml",
        ),
    ] {
        let error = read(&with(&text, column, value), &camera).unwrap_err();
        let expected = format!("records, line 3: {expected}");
        assert!(
            error.to_string().starts_with(&expected),
            "{error}\n{expected}"
        );
    }
}

#[test]
fn records_of_another_camera_are_refused_even_without_its_identity() {
    let (_, ours) = camera();
    let (file, _) = CameraFile::parse("other.toml", &IXM.replace("51.3712", "51.3713")).unwrap();
    let other = FrameCamera::new("other.toml", &file).unwrap();
    let (written, _) = flight(ours.camera(), ours.crc());
    let error = read(&csv(&written), &other).unwrap_err();
    let expected = format!(
        "records, line 2: calibration_crc32 = {:08x}: a record of another calibration than \
         other.toml, which has {:08x}",
        ours.crc(),
        other.crc()
    );
    assert_eq!(error.to_string(), expected);
    let (anonymous, _) = flight(ours.camera(), 0);
    assert!(read(&csv(&anonymous), &ours).is_ok());
    let error = read(&csv(&anonymous), &other).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("principal_distance_mm = 51.3712: must be 51.3713"),
        "{error}"
    );
}

#[test]
fn missing_columns_and_half_files_are_refused() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    let text = csv(&written[..2]);
    let error = read(&text.replacen("variance_mm2", "variance", 1), &camera).unwrap_err();
    assert_eq!(
        error.to_string(),
        "records, line 1: column variance_mm2 is missing"
    );
    let half = text.trim_end().strip_suffix(",1").unwrap();
    let error = read(half, &camera).unwrap_err();
    assert_eq!(
        error.to_string(),
        "records, line 3: 47 columns where the header has 48"
    );
    for empty in ["", " \n"] {
        let error = read(empty, &camera).unwrap_err();
        assert_eq!(error.to_string(), "records: the file is empty");
    }
    let header = text.lines().next().unwrap();
    assert_eq!(
        read(header, &camera).unwrap_err().to_string(),
        "records: it holds no records"
    );

    let text = json(&written[..2]);
    for length in (0..text.trim_end().len()).step_by(97).skip(1) {
        let error = read(&text[..length], &camera).unwrap_err();
        assert!(
            error.to_string().starts_with("records: EOF while parsing"),
            "{error}"
        );
    }
    for (wrong, expected) in [
        ("{}", "records: missing field `records`"),
        (
            "[]",
            "records: invalid type: sequence, expected an object with the key records",
        ),
        (
            "{\"records\": {}}",
            "records: invalid type: map, expected an array of records",
        ),
        ("{\"records\": []}", "records: it holds no records"),
        ("{\"records\": [{}]}", "records: missing field `sequence`"),
    ] {
        let error = read(wrong, &camera).unwrap_err();
        assert!(error.to_string().starts_with(expected), "{error}");
    }
    let twice = text.replace("\"sequence\": 2", "\"sequence\": 1");
    let error = read(&twice, &camera).unwrap_err();
    assert_eq!(
        error.to_string(),
        "records, record 2: sequence 1 appears twice"
    );
    let null = text.replacen("\"sequence\": 2", "\"sequence\": null", 1);
    assert!(
        read(&null, &camera)
            .unwrap_err()
            .to_string()
            .starts_with("records: invalid type: null")
    );
}
