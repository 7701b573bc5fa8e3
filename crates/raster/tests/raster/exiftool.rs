//! Metadata of input and output, as `ExifTool` reads it where it is present.

use std::path::Path;
use std::process::Command;

use fmc_raster::{ByteOrder, TagOptions};

use crate::tags::{copy, file};

/// Returns the metadata that `ExifTool` reads of a file, sorted lines `[group] tag: value`.
fn read_by_exiftool(path: &Path) -> Option<Vec<String>> {
    let output = Command::new("exiftool")
        .args(["-a", "-u", "-n", "-s", "-G1"])
        .arg(path)
        .output()
        .ok()?;
    let groups = [
        "[ExifIFD]",
        "[GPS]",
        "[InteropIFD]",
        "[XMP-",
        "[IPTC]",
        "[Photoshop]",
    ];
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines = text
        .lines()
        .filter(|line| groups.iter().any(|group| line.starts_with(group)));
    let mut lines: Vec<String> = lines.map(str::to_owned).collect();
    lines.sort();
    Some(lines)
}

#[test]
fn exiftool_reads_the_same_metadata_of_input_and_output() {
    let folder = tempfile::tempdir().unwrap();
    let options = TagOptions {
        keep_georeference: true,
        camera: None,
    };
    for (order, big) in [
        (ByteOrder::LittleEndian, false),
        (ByteOrder::BigEndian, false),
        (ByteOrder::BigEndian, true),
    ] {
        let path = folder.path().join("frame.tif");
        std::fs::write(&path, file(order, big, false)).unwrap();
        let Some(before) = read_by_exiftool(&path) else {
            println!("ExifTool is absent: its reading of the metadata is not compared");
            return;
        };
        std::fs::write(&path, copy(&file(order, big, false), &options, big).0).unwrap();
        let after = read_by_exiftool(&path).unwrap();
        // It does not follow the pointers to EXIF and GPS in a BigTIFF.
        let least = if big { 4 } else { 20 };
        assert!(before.len() >= least, "{before:?}");
        assert_eq!(before, after);
    }
}
