//! The storage that the page keeps for the library's structures.

use fmc_camera_c::{
    fmc_calibration_id, fmc_camera, fmc_camera_record, fmc_error, fmc_exposure, fmc_frame,
    fmc_interior,
};

const PAGE: &str = include_str!("../../page/camera.js");

/// Words of 32 bits that the page has for a structure.
fn words(name: &str) -> usize {
    let (_, rest) = PAGE.split_once("const WORDS = {").unwrap();
    let (table, _) = rest.split_once('}').unwrap();
    let entries = table.split(',').map(str::trim);
    let mut entries = entries.filter_map(|entry| entry.split_once(": "));
    let (_, number) = entries.find(|(found, _)| *found == name).unwrap();
    number.parse().unwrap()
}

#[test]
fn page_keeps_as_many_words_for_a_structure_as_it_has() {
    for (name, bytes) in [
        ("record", size_of::<fmc_camera_record>()),
        ("exposure", size_of::<fmc_exposure>()),
        ("interior", size_of::<fmc_interior>()),
        ("camera", size_of::<fmc_camera>()),
        ("frame", size_of::<fmc_frame>()),
        ("error", size_of::<fmc_error>()),
        ("id", size_of::<fmc_calibration_id>()),
    ] {
        assert_eq!(4 * words(name), bytes, "{name}");
    }
}
