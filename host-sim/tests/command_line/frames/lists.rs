//! Image-coordinate lists, read back by readers of their own.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;

use super::flight::{Flight, RECORDS, flight};

/// Coordinates in mm by image and point.
type List = BTreeMap<String, BTreeMap<String, [f64; 2]>>;

/// Points of seven frames, in an order in which the image changes with every point.
fn points() -> String {
    let mut text = String::from("point,sequence,x_mm,y_mm\n");
    for point in 1..=9_i32 {
        for sequence in [8, 1, 7, 2, 6, 3, 4] {
            let [x, y] = [4 * point - 20, sequence * 3 - point];
            writeln!(text, "{},{sequence},{x},{y}", 100 + point).unwrap();
        }
    }
    text
}

fn list(flight: &Flight, program: &str, more: &[&str]) -> String {
    fs::write(flight.bench.path("points.csv"), points()).unwrap();
    let arguments = ["--answer", "ideal-shifted", "--list", program, "points.csv"];
    let arguments = [&["correct"], &RECORDS[..], more, &arguments].concat();
    flight.bench.run(&arguments).ok().stdout
}

/// Returns what the CSV of the same points says.
fn expected(flight: &Flight) -> BTreeMap<(u32, String), [f64; 2]> {
    let arguments = ["--answer", "ideal-shifted", "points.csv"];
    let arguments = [&["correct"], &RECORDS[..], &arguments].concat();
    let text = flight.bench.run(&arguments).ok().stdout;
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    rows.records()
        .map(|row| {
            let row = row.unwrap();
            let number = |place: usize| row[place].parse::<f64>().unwrap();
            let key = (row[1].parse().unwrap(), row[0].to_owned());
            (key, [number(2), number(3)])
        })
        .collect()
}

/// Reader of BINGO's lists: a line for the image, lines of points, -99.
fn read_bingo(text: &str) -> List {
    let mut list = List::new();
    let mut lines = text.lines();
    while let Some(head) = lines.next() {
        let words: Vec<&str> = head.split_whitespace().collect();
        assert_eq!(words[1..], ["Testcamera"]);
        let points = lines.by_ref().map_while(|line| point(line, 1.0)).collect();
        assert!(list.insert(words[0].to_owned(), points).is_none());
    }
    list
}

/// Reader of PAT-B's: the same in µm, with the principal distance behind the photo's number.
fn read_patb(text: &str) -> List {
    let mut list = List::new();
    let mut lines = text.lines();
    while let Some(head) = lines.next() {
        let words: Vec<&str> = head.split_whitespace().collect();
        assert_eq!(words[1..], ["100000.000"]);
        let points = lines.by_ref().map_while(|line| point(line, 1e-3)).collect();
        assert!(list.insert(words[0].to_owned(), points).is_none());
    }
    list
}

/// Returns a point of a line, or `None` at the end of an image.
fn point(line: &str, scale: f64) -> Option<(String, [f64; 2])> {
    let words: Vec<&str> = line.split_whitespace().collect();
    if words == ["-99"] {
        return None;
    }
    assert_eq!(words.len(), 3, "{line}");
    let number = |place: usize| scale * words[place].parse::<f64>().unwrap();
    Some((words[0].to_owned(), [number(1), number(2)]))
}

/// Reader of Inpho's blocks.
fn read_inpho(text: &str) -> List {
    let mut list = List::new();
    let mut image = None;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (&mut image, words.as_slice()) {
            (None, ["$PHOTO"]) | (Some(_), ["$PHOTO_POINTS", ":"]) => {}
            (None, ["$PHOTO_NUM", ":", id]) => {
                assert!(list.insert((*id).to_owned(), BTreeMap::new()).is_none());
                image = Some((*id).to_owned());
            }
            (Some(_), ["$END_POINTS"]) => {}
            (Some(_), ["$END"]) => image = None,
            (Some(image), [id, x, y, "1.00", "2", "{", "*", "}"]) => {
                let place = [x.parse().unwrap(), y.parse().unwrap()];
                let points = list.get_mut(image).unwrap();
                assert!(points.insert((*id).to_owned(), place).is_none());
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(image, None);
    list
}

#[test]
fn lists_hold_the_coordinates_image_by_image() {
    let flight = flight();
    for program in ["bingo", "patb", "inpho"] {
        for images in [false, true] {
            let more: &[&str] = if images {
                &["--images", "stems.csv"]
            } else {
                &[]
            };
            let mut map = String::from("sequence,image\n");
            for sequence in 1..=8 {
                writeln!(map, "{sequence},strip/IMG_{sequence:03}.tif").unwrap();
            }
            fs::write(flight.bench.path("stems.csv"), map).unwrap();
            let text = list(&flight, program, more);
            let list = match program {
                "bingo" => read_bingo(&text),
                "patb" => read_patb(&text),
                _ => read_inpho(&text),
            };
            let expected = expected(&flight);
            assert_eq!(list.len(), 7);
            let mut compared = 0;
            for ((sequence, point), expected) in expected {
                let image = match (images, program) {
                    (true, "bingo" | "inpho") => format!("IMG_{sequence:03}"),
                    _ => sequence.to_string(),
                };
                let found = list[&image][&point];
                for (found, expected) in found.into_iter().zip(expected) {
                    // Six decimals of a millimetre.
                    assert!((found - expected).abs() < 0.51e-6, "{found} {expected}");
                }
                compared += 1;
            }
            assert_eq!(compared, 63);
            assert_eq!(list.values().map(BTreeMap::len).sum::<usize>(), 63);
        }
    }
    let text = list(&flight, "bingo", &[]);
    let heads = text.lines().filter(|line| line.ends_with("Testcamera"));
    let order: Vec<&str> = heads.map(|line| line.split(' ').next().unwrap()).collect();
    assert_eq!(order, ["1", "2", "3", "4", "6", "7", "8"]);
}

#[test]
fn what_a_list_cannot_hold_is_refused() {
    let flight = flight();
    let run = |points: &str, more: &[&str]| {
        fs::write(flight.bench.path("points.csv"), points).unwrap();
        // Whole, or not at all.
        let out = ["points.csv", "--out", "list.txt"];
        let arguments = [&["correct"], &RECORDS[..], more, &out].concat();
        let _ = fs::remove_file(flight.bench.path("list.txt"));
        flight.bench.run(&arguments)
    };
    let shifted = ["--answer", "ideal-shifted", "--list"];
    let with = |program| [&shifted[..], &[program]].concat();
    let one = |id: &str| format!("point,sequence,x_mm,y_mm\n11,1,1,2\n{id},2,3,4\n");
    run(&one("p1"), &with("bingo")).ok();
    run(&one("p1"), &with("patb")).refused(&[
        "points.csv, line 3: point = \"p1\": must be a whole number from 1 on, without leading zeros",
    ]);
    run(&one("007"), &with("patb")).refused(&["point = \"007\": must be a whole number"]);
    let long = "1234567890123456";
    for program in ["bingo", "patb"] {
        run(&one(long), &with(program)).refused(&[
            "point = \"1234567890123456\": is longer than the 15 characters of the format",
        ]);
    }
    run(&one("-99"), &with("bingo")).refused(&["point = \"-99\": must not begin with -"]);
    run(&one("a b"), &with("inpho")).refused(&["point = \"a b\": must be letters"]);
    run(&one("{x}"), &with("inpho")).refused(&["point = \"{x}\": must not begin"]);
    let twice = format!("{}11,1,5,6\n", one("12"));
    run(&twice, &with("bingo")).refused(&["point 11 stands twice in image 1"]);
    assert!(!flight.bench.path("list.txt").exists());
    run(&one("12"), &["--list", "bingo"]).refused(&["--answer ideal-shifted or measured-shifted"]);
    run(&one("12").replace("point", "name"), &with("inpho"))
        .refused(&["--list: the points must be CSV with a column point, or id"]);
    let flagged = [&with("bingo")[..], &["--off-sensor", "flag"]].concat();
    run(&one("12"), &flagged).refused(&["--list: it has no place for flags"]);
    // The images of two folders have the same name.
    let map = "sequence,image\n1,a/7.tif\n2,b/7.tif\n";
    fs::write(flight.bench.path("same.csv"), map).unwrap();
    let images = [&with("bingo")[..], &["--images", "same.csv"]].concat();
    run(&one("12"), &images).refused(&["image = \"7\" of frame 2 is that of frame 1, too"]);
    // A point of a refused trigger is left out.
    let skipped = [&with("bingo")[..], &["--off-sensor", "skip"]].concat();
    run(&format!("{}13,5,0,0\n", one("12")), &skipped).ok();
    let text = fs::read_to_string(flight.bench.path("list.txt")).unwrap();
    assert_eq!(text.lines().filter(|line| line.trim() == "-99").count(), 2);
}
