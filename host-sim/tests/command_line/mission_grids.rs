//! `mission` of a camera with residual grids.

use std::fs;

use fmc_camera::SensorPoint;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader};

use crate::command_line::mission::{CAMERA, MISSION, bench, fly};
use crate::command_line::support::Bench;

/// Returns the file of a grid of the lens with structure of 3 µm, and its CRC-32.
pub(crate) fn grid() -> (Vec<u8>, u32) {
    let header = GridHeader {
        carrier: GridCarrier::Lens,
        columns: 64,
        rows: 64,
        first_node: SensorPoint::new(-63.0, -63.0),
        pitch_mm: 2.0,
        scale_mm: 1e-7,
    };
    let mut file = header.to_bytes().to_vec();
    for node in 0..64 * 64 {
        let value = |factor: i32| i16::try_from(node * factor % 60_001 - 30_000).unwrap();
        for component in [value(7919), value(104_729)] {
            file.extend(component.to_le_bytes());
        }
    }
    let crc = GridHeader::checksum(&file);
    file.extend(crc.to_le_bytes());
    (file, crc)
}

/// Returns a column of the records, without its header.
fn column(bench: &Bench, folder: &str, name: &str) -> Vec<String> {
    let mut rows = csv::Reader::from_path(bench.path(&format!("{folder}/records.csv"))).unwrap();
    let place = rows
        .headers()
        .unwrap()
        .iter()
        .position(|header| header == name)
        .unwrap_or_else(|| panic!("no column {name}"));
    rows.records()
        .map(|row| row.unwrap()[place].to_owned())
        .collect()
}

#[test]
fn records_have_the_identity_of_the_camera_with_its_grid_and_state_what_it_leaves_out() {
    let bench = bench(MISSION);
    let flown = |folder| {
        fly(&bench, &["--exposures", "5", "--out", folder]).ok();
        let number = |text: String| text.parse::<f64>().unwrap();
        let crc = column(&bench, folder, "calibration_crc32");
        let left_out: Vec<f64> = column(&bench, folder, "left_out_nm")
            .into_iter()
            .map(number)
            .collect();
        let place = column(&bench, folder, "principal_point_y_mm");
        assert_eq!((crc.len(), left_out.len()), (5, 5));
        (crc, left_out, place)
    };
    let (plain_crc, plain, place) = flown("plain");
    let (file, crc) = grid();
    fs::write(bench.path("cameras/lens.fmcg"), file).unwrap();
    let table = format!("\n[grid]\nlens = \"lens.fmcg\"\nlens_crc32 = \"{crc:08x}\"\n");
    fs::write(
        bench.path("cameras/mission.toml"),
        CAMERA.to_owned() + &table,
    )
    .unwrap();
    let (gridded_crc, gridded, moved) = flown("gridded");
    assert!(gridded_crc.iter().all(|crc| *crc == gridded_crc[0]));
    assert_ne!(gridded_crc[0], plain_crc[0]);
    for (gridded, plain) in gridded.iter().zip(plain) {
        assert!(*gridded > plain + 0.01, "{gridded} {plain}");
    }
    assert_eq!(place, moved);
}

#[test]
fn grid_that_is_missing_or_another_is_named_before_the_flight() {
    let bench = bench(MISSION);
    let (file, crc) = grid();
    let with = |name: &str, crc: u32| {
        let table = format!("\n[grid]\nlens = \"{name}\"\nlens_crc32 = \"{crc:08x}\"\n");
        fs::write(
            bench.path("cameras/mission.toml"),
            CAMERA.to_owned() + &table,
        )
        .unwrap();
        fly(&bench, &["--exposures", "2"])
    };
    with("lens.fmcg", crc).failed(2, &["cameras/lens.fmcg"]);
    fs::write(bench.path("cameras/lens.fmcg"), &file[..1000]).unwrap();
    with("lens.fmcg", crc).failed(
        2,
        &["cameras/mission.toml", "1000 bytes of a residual grid"],
    );
    fs::write(bench.path("cameras/lens.fmcg"), &file).unwrap();
    with("lens.fmcg", crc ^ 1).failed(2, &["grid.lens_crc32", "another calibration"]);
    assert!(!bench.path("report").exists());
}
