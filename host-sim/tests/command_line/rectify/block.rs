//! Blocks of frames: the same bytes whatever interrupts or divides them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, SystemTime};

use super::scene::{EXPOSED, TILED, read, scene, write};
use crate::command_line::frames::flight::{Flight, REFUSED};

/// Bytes of all images and descriptions of a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .filter(|(name, _)| !name.starts_with("manifest"))
        .collect()
}

/// Counts the frames that are finished.
fn finished(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else {
        return 0;
    };
    let names = entries.map(|entry| entry.unwrap().path());
    names
        .filter(|path| path.extension().is_some_and(|end| end == "json"))
        .count()
}

fn rectify<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["rectify", "--camera", "camera.toml", "--records"];
    arguments.extend(["records.csv", "--frames", "frames.csv", "--out", out]);
    arguments.extend(more);
    arguments
}

/// Runs a block, in which the frame of the refused trigger fails.
fn run(flight: &Flight, out: &str, more: &[&str]) -> String {
    let mut arguments = rectify(out, more);
    arguments.push("--keep-going");
    let answer = flight.bench.run(&arguments);
    assert!([0, 2].contains(&answer.code), "{}", answer.stderr);
    answer.stderr
}

#[test]
fn bytes_depend_on_neither_threads_nor_parts_nor_memory() {
    let flight = scene();
    // Frames of another layout are read as well.
    let path = flight.bench.path("f2.tif");
    let (samples, _) = read(&path);
    write(&path, &samples, &TILED);
    run(&flight, "one", &["--threads", "1", "--mask"]);
    run(&flight, "two", &["--threads", "2", "--mask"]);
    for shard in ["1/3", "2/3", "3/3"] {
        run(
            &flight,
            "three",
            &["--shard", shard, "--mask", "--memory", "1"],
        );
    }
    let one = contents(&flight.bench.path("one"));
    assert_eq!(one.len(), 2 * EXPOSED.len() + 1);
    assert_eq!(one, contents(&flight.bench.path("two")));
    assert_eq!(one, contents(&flight.bench.path("three")));
    let mut rows = 0;
    for shard in 1..=3 {
        let manifest = flight
            .bench
            .path(&format!("three/manifest-{shard}-of-3.csv"));
        rows += csv::Reader::from_path(manifest).unwrap().records().count();
    }
    assert_eq!(rows, 8);
}

#[test]
fn manifest_has_a_row_for_every_frame() {
    let flight = scene();
    let stderr = run(&flight, "out", &[]);
    assert!(stderr.contains("refused trigger"), "{stderr}");
    let mut reader = csv::Reader::from_path(flight.bench.path("out/manifest.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 8);
    for (sequence, row) in (1..).zip(&rows) {
        assert_eq!(&row[0], format!("f{sequence}.tif"));
        assert_eq!(row[1], sequence.to_string());
        let is_refused = sequence == REFUSED;
        assert_eq!(&row[2], if is_refused { "2" } else { "0" });
        assert_eq!(row[3].is_empty(), is_refused);
        assert_eq!(row[9].is_empty(), !is_refused);
    }
    assert!(!flight.bench.path("out/f5.tif").exists());
}

#[test]
fn first_failure_ends_the_run_unless_told_otherwise() {
    let flight = scene();
    let answer = flight.bench.run(&rectify("out", &[]));
    answer.refused(&["f5.tif", "record 5", "refused trigger"]);
    assert!(flight.bench.path("out/f4.tif").exists());
    assert!(!flight.bench.path("out/f6.tif").exists());
}

#[test]
fn interrupted_block_ends_as_one_that_was_not() {
    let flight = scene();
    run(&flight, "whole", &["--compression", "deflate"]);
    let more = ["--compression", "deflate", "--resume", "--keep-going"];
    // A little longer each time, until none is left to do.
    let mut kills = 0;
    while finished(&flight.bench.path("killed")) < EXPOSED.len() {
        kills += 1;
        let mut child = flight
            .bench
            .command(&rectify("killed", &more))
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        thread::sleep(Duration::from_millis(3 * kills));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(kills >= 5, "{kills}");
    run(&flight, "killed", &["--compression", "deflate", "--resume"]);
    let [whole, killed] = ["whole", "killed"].map(|out| contents(&flight.bench.path(out)));
    assert_eq!(whole, killed);
    let manifest = flight.bench.path("killed/manifest.csv");
    let rows = csv::Reader::from_path(manifest).unwrap().into_records();
    let mut files: Vec<String> = rows.map(|row| row.unwrap()[0].to_owned()).collect();
    files.sort();
    assert_eq!(
        files,
        (1..=8).map(|n| format!("f{n}.tif")).collect::<Vec<_>>()
    );
}

#[test]
fn two_runs_in_one_folder_end_as_one() {
    let flight = scene();
    run(&flight, "one", &[]);
    let children = [(); 2].map(|()| {
        let arguments = rectify("two", &["--keep-going"]);
        let mut command = flight.bench.command(&arguments);
        command.stderr(Stdio::null()).spawn().unwrap()
    });
    for mut child in children {
        // The frame of the refused trigger fails.
        assert_eq!(child.wait().unwrap().code(), Some(2));
    }
    let [one, two] = ["one", "two"].map(|out| contents(&flight.bench.path(out)));
    assert_eq!(one, two);
    let manifest = csv::Reader::from_path(flight.bench.path("two/manifest.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = manifest.into_records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 8);
    for sequence in EXPOSED {
        let name = format!("f{sequence}.tif");
        assert!(
            rows.iter().any(|row| row[0] == name && row[2] == *"0"),
            "{name}"
        );
    }
}

#[test]
fn resumed_block_does_what_has_changed() {
    let flight = scene();
    run(&flight, "out", &[]);
    let modified = |name: &str| {
        let metadata = fs::metadata(flight.bench.path(&format!("out/{name}"))).unwrap();
        metadata.modified().unwrap()
    };
    let before = [modified("f1.tif"), modified("f2.tif")];
    let path = flight.bench.path("f2.tif");
    let (samples, _) = read(&path);
    write(&path, &samples, &TILED);
    let stderr = run(&flight, "out", &["--resume"]);
    assert!(
        stderr.contains("1 rectified, 6 finished before, 1 failed"),
        "{stderr}"
    );
    let after = [modified("f1.tif"), modified("f2.tif")];
    assert_eq!(before[0], after[0]);
    assert!(before[1] < after[1]);
}

/// Sets the time of a file's last change to a day ago, as a copy has another one than its original.
fn age(path: &Path) {
    let file = fs::File::options().write(true).open(path).unwrap();
    let yesterday = SystemTime::now() - Duration::from_hours(24);
    file.set_modified(yesterday).unwrap();
}

#[test]
fn copies_of_frames_have_the_same_bytes_and_are_not_done_again() {
    let flight = scene();
    run(&flight, "out", &[]);
    let before = contents(&flight.bench.path("out"));
    for number in 1..=8 {
        age(&flight.bench.path(&format!("f{number}.tif")));
    }
    let stderr = run(&flight, "out", &["--resume"]);
    let finished = "0 rectified, 7 finished before, 1 failed";
    assert!(stderr.contains(finished), "{stderr}");
    run(&flight, "other", &[]);
    for out in ["out", "other"] {
        assert_eq!(before, contents(&flight.bench.path(out)), "{out}");
    }
    // Another frame of the same length and age is no copy: one pixel differs, or a tag.
    for name in ["f1.tif", "f2.tif"] {
        let path = flight.bench.path(name);
        let mut bytes = fs::read(&path).unwrap();
        if name == "f1.tif" {
            // Within the only strip, which is 132,000 bytes of the file.
            bytes[60_000] ^= 1;
        } else {
            // The numerator of XResolution (282), a fraction at the place that its entry names.
            let entry = [0x1a, 1, 5, 0, 1, 0, 0, 0];
            let place = bytes.windows(8).position(|w| w == entry).unwrap() + 8;
            let place = u32::from_le_bytes(bytes[place..place + 4].try_into().unwrap());
            bytes[place as usize] ^= 1;
        }
        fs::write(&path, bytes).unwrap();
        age(&path);
    }
    let stderr = run(&flight, "out", &["--resume"]);
    let finished = "2 rectified, 5 finished before, 1 failed";
    assert!(stderr.contains(finished), "{stderr}");
}

#[test]
fn resumed_block_with_other_options_is_refused() {
    let flight = scene();
    run(&flight, "out", &[]);
    let before = contents(&flight.bench.path("out"));
    let arguments = rectify("out", &["--resume", "--resample", "keys6"]);
    let answer = flight.bench.run(&arguments);
    answer.refused(&["--resample is keys6", "f1.json", "--resample bicubic"]);
    assert_eq!(before, contents(&flight.bench.path("out")));
}

#[test]
fn resumed_block_mends_what_is_cut_off_or_missing() {
    let flight = scene();
    run(&flight, "out", &[]);
    let whole = contents(&flight.bench.path("out"));
    let image = flight.bench.path("out/f2.tif");
    fs::File::options()
        .write(true)
        .open(image)
        .unwrap()
        .set_len(1000)
        .unwrap();
    fs::remove_file(flight.bench.path("out/rectified-camera.toml")).unwrap();
    run(&flight, "out", &["--resume"]);
    assert_eq!(whole, contents(&flight.bench.path("out")));
}

#[test]
fn folder_holds_images_of_one_camera() {
    let flight = scene();
    run(&flight, "out", &["--shard", "1/2"]);
    let before = contents(&flight.bench.path("out"));
    let more = ["--shard", "2/2", "--resume", "--window", "200x200"];
    let answer = flight.bench.run(&rectify("out", &more));
    answer.refused(&["out/rectified-camera.toml", "200 x 200 px"]);
    assert_eq!(before, contents(&flight.bench.path("out")));
}

#[test]
fn chosen_frames_have_the_records_of_the_table() {
    let flight = scene();
    fs::rename(flight.bench.path("f3.tif"), flight.bench.path("third.tif")).unwrap();
    fs::write(
        flight.bench.path("frames.csv"),
        "file,sequence\nthird.tif,3\nf4.tif,4\n",
    )
    .unwrap();
    flight.bench.run(&rectify("out", &["third.tif"])).ok();
    assert_eq!(contents(&flight.bench.path("out")).len(), 3);
    let answer = flight.bench.run(&rectify("out", &["f1.tif"]));
    answer.refused(&["f1.tif", "not in frames.csv"]);
}
