//! `frame` and `mesh` for the frames of a flight.

use std::fs;

use super::flight::{RECORDS, flight};
use crate::command_line::support::{Bench, CAMERA, EXPOSURE};

#[test]
fn frame_lists_every_trigger_by_the_names_of_the_records() {
    let flight = flight();
    let arguments = [&["frame"], &RECORDS[..], &["--images", "images.csv"]].concat();
    let listed = flight.bench.run(&arguments).ok().stdout;
    let records = fs::read_to_string(flight.bench.path("records.csv")).unwrap();
    let [mut listed, mut records] =
        [&listed, &records].map(|text| csv::Reader::from_reader(text.as_bytes()));
    let (names, known) = (
        listed.headers().unwrap().clone(),
        records.headers().unwrap().clone(),
    );
    let mut compared = 0;
    for (listed, record) in listed.records().zip(records.records()) {
        let (listed, record) = (listed.unwrap(), record.unwrap());
        for (name, cell) in names.iter().zip(&listed) {
            match known.iter().position(|one| one == name) {
                Some(place) => {
                    compared += 1;
                    assert_eq!(cell, &record[place], "{name}");
                }
                None => assert_eq!(
                    (name, cell),
                    (
                        "image",
                        &*format!("IMG, {:03}.tif", record[0].parse::<u32>().unwrap())
                    )
                ),
            }
        }
    }
    assert_eq!(compared, 8 * (names.len() - 1));
    let json = flight
        .bench
        .run(&[&["frame"], &RECORDS[..], &["--json"]].concat())
        .ok()
        .stdout;
    let lines: Vec<serde_json::Value> = json
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 8);
    assert_eq!(lines[4]["reason"], "not at speed");
    assert!(lines[4]["travel_mm"].is_null());
    assert_eq!(lines[7]["sequence"], 8);
}

#[test]
fn mesh_of_a_frame_is_that_of_its_exposure() {
    let bench = Bench::with(CAMERA, b"");
    fs::write(
        bench.path("frames.csv"),
        "sequence,vh,exposure,direction\n3,0.12,1/300,\n12,0.1,1/200,reverse\n",
    )
    .unwrap();
    let mesh = ["--format", "gpu", "--spacing", "1024", "--out"];
    let frames = ["mesh", "--camera", "camera.toml", "--frames", "frames.csv"];
    bench.run(&[&frames[..], &mesh, &["all"]].concat()).ok();
    bench
        .run(
            &[
                &["mesh"],
                &EXPOSURE[..],
                &mesh,
                &["one", "--direction", "reverse"],
            ]
            .concat(),
        )
        .ok();
    let read = |name: &str| fs::read(bench.path(name)).unwrap();
    assert!(read("all/00012/mesh.bin") == read("one/mesh.bin"));
    assert!(read("all/00003/mesh.bin") != read("one/mesh.bin"));
    let header = String::from_utf8(read("all/00012/mesh.json")).unwrap();
    assert_eq!(
        header.replace("\n  \"sequence\": 12,", "").as_bytes(),
        read("one/mesh.json")
    );
    bench
        .run(&[&frames[..], &mesh, &["single", "--sequence", "12"]].concat())
        .ok();
    assert!(read("single/mesh.bin") == read("one/mesh.bin"));
    bench
        .run(&[&frames[..], &mesh, &["single", "--sequence", "13"]].concat())
        .refused(&["--sequence 13: there is no such frame in frames.csv"]);

    let flight = flight();
    let answer = flight
        .bench
        .run(&[&["mesh"], &RECORDS[..], &mesh, &["all"]].concat())
        .ok();
    assert!(
        answer
            .stderr
            .contains("note: no mesh of the refused triggers 5"),
        "{}",
        answer.stderr
    );
    assert!(flight.bench.path("all/00008/mesh.json").exists());
    assert!(!flight.bench.path("all/00005").exists());
    flight
        .bench
        .run(&[&["mesh"], &RECORDS[..], &mesh, &["all", "--sequence", "5"]].concat())
        .refused(&["--sequence 5: the trigger was refused (not at speed)"]);
}
