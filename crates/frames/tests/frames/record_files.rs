//! Records that are put in doubt after they have been written.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_frames::record_files::{RecordDocument, RecordFiles};
use fmc_frames::row::{Row, write_csv};

use crate::support::{camera, flight};

/// Records of triggers 41 to 60, whose exposures have been found 5 µm off.
const EXPOSURES: InDoubt = InDoubt {
    from_sequence: 41,
    triggers: 20,
    off_mm: -5e-3,
    is_fault: true,
};

fn write(folder: &Path, records: &[FrameRecord], in_doubt: Option<InDoubt>) {
    let mut csv = Vec::new();
    write_csv(records, &mut csv).unwrap();
    fs::write(folder.join("records.csv"), csv).unwrap();
    let document = RecordDocument {
        camera: Some("bare".to_owned()),
        conventions: vec![Cow::Borrowed("as they are")],
        records_crc32: "00000000".to_owned(),
        in_doubt,
        records: records.iter().map(Row::of).collect(),
    };
    let mut json = Vec::new();
    document.write(&mut json).unwrap();
    fs::write(folder.join("records.json"), json).unwrap();
}

fn written(files: &RecordFiles) -> [Vec<u8>; 2] {
    let (mut csv, mut json) = (Vec::new(), Vec::new());
    files.write_csv(&mut csv).unwrap();
    files.write_json(&mut json).unwrap();
    [csv, json]
}

fn read(folder: &Path) -> [Vec<u8>; 2] {
    ["records.csv", "records.json"].map(|name| fs::read(folder.join(name)).unwrap())
}

#[test]
fn files_of_records_in_doubt_are_those_of_records_that_the_camera_has_marked() {
    let (_, camera) = camera();
    let (mut records, _) = flight(camera.camera(), camera.crc());
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &records, None);
    let mut files = RecordFiles::read(folder.path()).unwrap();
    assert_eq!(written(&files), read(folder.path()), "read and written");

    assert_eq!(files.doubt(&EXPOSURES), 20);
    for record in &mut records {
        record.doubt(&EXPOSURES);
    }
    write(folder.path(), &records, Some(EXPOSURES));
    assert_eq!(written(&files), read(folder.path()));
    let text = String::from_utf8(written(&files)[0].clone()).unwrap();
    assert_eq!(text.matches(",encoder,14,").count(), 20);

    // A doubt that is known already is marked once; a larger difference is marked again.
    let mut again = RecordFiles::read(folder.path()).unwrap();
    assert_eq!(again.doubt(&EXPOSURES), 0);
    assert_eq!(written(&again), read(folder.path()));
    let wider = InDoubt {
        triggers: 21,
        ..EXPOSURES
    };
    assert_eq!(again.doubt(&wider), 1);
    let larger = InDoubt {
        off_mm: 6e-3,
        ..EXPOSURES
    };
    assert_eq!(again.doubt(&larger), 20);
}

#[test]
fn table_alone_is_read_to_its_last_whole_row_and_marked_once() {
    let (_, camera) = camera();
    let (mut records, _) = flight(camera.camera(), camera.crc());
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &records, None);
    fs::remove_file(folder.path().join("records.json")).unwrap();
    let table = folder.path().join("records.csv");
    let whole = fs::read(&table).unwrap();
    fs::write(&table, &whole[..whole.len() - 1]).unwrap();
    let files = RecordFiles::read(folder.path()).unwrap();
    let last = records.last().unwrap().sequence;
    assert!(!files.has(last) && files.has(last - 1) && !files.has_json());
    fs::write(&table, &whole).unwrap();

    let mut files = RecordFiles::read(folder.path()).unwrap();
    assert_eq!(files.doubt(&EXPOSURES), 20);
    for record in &mut records {
        assert_eq!(files.is_same(record), Some(true));
        record.doubt(&EXPOSURES);
        assert_eq!(files.is_same(record), Some(true));
        record.trigger = record.trigger.plus_s(1e-3);
        assert_eq!(files.is_same(record), Some(false));
    }
    let [marked, json] = written(&files);
    assert_eq!(json, b"");
    fs::write(&table, &marked).unwrap();
    let mut again = RecordFiles::read(folder.path()).unwrap();
    assert_eq!(again.doubt(&EXPOSURES), 0);
    assert_eq!(written(&again)[0], marked);
    let larger = InDoubt {
        off_mm: 20e-3,
        ..EXPOSURES
    };
    assert_eq!(again.doubt(&larger), 20);
}

#[test]
fn refused_triggers_are_not_in_doubt() {
    let (_, camera) = camera();
    let (records, _) = flight(camera.camera(), camera.crc());
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &records, None);
    let mut files = RecordFiles::read(folder.path()).unwrap();
    let last = InDoubt {
        from_sequence: 200,
        triggers: 2,
        ..EXPOSURES
    };
    assert_eq!(files.doubt(&last), 1);
}

#[test]
fn files_that_are_not_those_of_one_flight_are_refused_by_name() {
    let (_, camera) = camera();
    let (records, _) = flight(camera.camera(), camera.crc());
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str| {
        let error = RecordFiles::read(folder.path()).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    };
    refused("records.csv");
    write(folder.path(), &records, None);
    let json = fs::read(folder.path().join("records.json")).unwrap();
    write(folder.path(), &records[1..], None);
    fs::write(folder.path().join("records.json"), &json).unwrap();
    refused("records.csv: other triggers");
    fs::write(folder.path().join("records.json"), &json[..1000]).unwrap();
    refused("records.json: EOF");
}
