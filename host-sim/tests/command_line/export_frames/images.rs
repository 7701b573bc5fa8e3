//! Names of the images.

use std::fs;

use super::{cell, export, flown, json, rows};

#[test]
fn images_have_the_names_of_the_map_or_of_the_pattern() {
    let bench = flown();
    let map = "image,sequence,note\nb.tif,2,x\na.tif,1,y\nd.tif,4,\n\"e,f.tif\",5,\n";
    fs::write(bench.path("map.csv"), map).unwrap();
    bench
        .run(&export("frames", "records.csv", &["--images", "map.csv"]))
        .ok();
    let found = rows(&bench, "frames/frames.csv");
    let images: Vec<&str> = found.iter().map(|row| cell(row, "image")).collect();
    assert_eq!(images, ["a.tif", "b.tif", "d.tif", "e,f.tif"]);
    assert_eq!(
        json(&bench, "frames/export.json")["frames"]["images"],
        "map.csv"
    );
    let pattern = ["--image-name", "s1/{sequence}.iiq"];
    bench.run(&export("frames", "records.csv", &pattern)).ok();
    let found = rows(&bench, "frames/frames.csv");
    assert_eq!(cell(&found[3], "image"), "s1/5.iiq");
}

#[test]
fn gaps_doubles_and_refused_triggers_of_the_map_are_refused_by_line() {
    let bench = flown();
    let with = |map: &str, words: &[&str]| {
        fs::write(bench.path("map.csv"), map).unwrap();
        let arguments = export("colmap", "records.csv", &["--images", "map.csv"]);
        bench.run(&arguments).refused(words);
    };
    with(
        "sequence,image\n1,a\n2,b\n5,e\n",
        &["map.csv", "sequence", "4 is missing"],
    );
    with(
        "sequence,image\n1,a\n2,b\n3,c\n4,d\n5,e\n",
        &["map.csv, line 4", "sequence = 3", "refused trigger (stall)"],
    );
    with(
        "sequence,image\n1,a\n2,b\n4,d\n5,e\n77,f\n",
        &["map.csv, line 6", "sequence = 77", "no record"],
    );
    with("sequence,image\n1,a\n1,b\n", &["map.csv, line 3", "twice"]);
    with("sequence,image\n1,a\n2,a\n", &["map.csv, line 3", "image"]);
    with("sequence,name\n1,a\n", &["map.csv, line 1", "column image"]);
    with(
        "sequence,image\n1,\"a\nb\"\n2,b\n4,d\n5,e\n",
        &["map.csv, line 2", "control character"],
    );
    assert!(!bench.path("colmap").exists());
}
