//! Files that people write or that come from other programs, damaged at random: each is refused by
//! name or read, and nothing else. The functions are those of the fuzz targets.

mod damage;

use std::fs;
use std::path::Path;

use crate::damaged_files::damage::Damage;

#[path = "../../../fuzz/files.rs"]
mod files;

/// Returns the files of folders of the project, in the order of their names.
fn inputs(folders: &[&str]) -> Vec<Vec<u8>> {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut paths: Vec<_> = folders
        .iter()
        .flat_map(|folder| fs::read_dir(project.join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Gives the inputs to a target as they are, of which it refuses some, then `count` damaged ones,
/// the same every time. Returns how many of the damaged ones it accepted.
fn run(target: fn(&[u8]) -> bool, inputs: &[Vec<u8>], refused: usize, count: u32) -> u32 {
    let accepted = inputs.iter().filter(|bytes| target(bytes)).count();
    assert!(inputs.len() > 2);
    assert_eq!(inputs.len() - accepted, refused, "of {}", inputs.len());
    let mut damage = Damage::with_seed(24);
    let damaged = (0..count).filter(|_| target(&damage.one_of(inputs)));
    u32::try_from(damaged.count()).unwrap()
}

#[test]
fn damaged_camera_files_are_refused_by_name_or_make_a_camera() {
    let folders = ["host-sim/cameras", "host-sim/scenarios/cameras"];
    let accepted = run(files::camera_file, &inputs(&folders), 0, 2000);
    assert!((200..1800).contains(&accepted), "{accepted}");
}

#[test]
fn damaged_scenarios_are_refused_by_name_or_can_be_flown() {
    let folders = ["host-sim/scenarios", "host-sim/scenarios/faults"];
    // Those of a strip and of Yuan 2012 are scenarios of other kinds.
    let accepted = run(files::scenario, &inputs(&folders), 2, 2000);
    assert!((200..1800).contains(&accepted), "{accepted}");
}

#[test]
fn damaged_files_of_other_programs_are_refused_by_name_or_have_finite_numbers() {
    let accepted = run(files::imports, &inputs(&["fuzz/corpus/imports"]), 0, 600);
    assert!((60..540).contains(&accepted), "{accepted}");
}

#[test]
fn damaged_records_are_refused_by_name_or_have_finite_numbers() {
    let accepted = run(files::records, &inputs(&["fuzz/corpus/records"]), 0, 2000);
    assert!((200..1800).contains(&accepted), "{accepted}");
}

#[test]
fn damaged_headers_of_arrays_are_refused_or_written_as_they_were_read() {
    let accepted = run(files::npy, &inputs(&["fuzz/corpus/npy"]), 0, 4000);
    assert!((200..3800).contains(&accepted), "{accepted}");
}
