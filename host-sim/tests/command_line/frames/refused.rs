//! Points without an answer, and requests that cannot be met.

use std::fs;

use super::flight::{RECORDS, flight};

const POINTS: &str = "id,sequence,x_mm,y_mm\na,1,1,2\nb,5,3,4\nc,2,50,6\nd,3,7,8\n";

#[test]
fn points_off_the_sensor_and_of_refused_triggers_are_an_error_left_out_or_marked() {
    let flight = flight();
    let run = |points: &str, more: &[&str]| {
        fs::write(flight.bench.path("points.csv"), points).unwrap();
        let arguments = [&["correct"], &RECORDS[..], more, &["points.csv"]].concat();
        flight.bench.run(&arguments)
    };
    run(POINTS, &[]).refused(&[
        "points.csv, line 3: frame 5: its trigger was refused (not at speed)",
        "--off-sensor",
    ]);
    run(&POINTS.replace("b,5", "b,6"), &[]).refused(&[
        "points.csv, line 4: frame 2: the point x_mm = 50, y_mm = 6 is off the sensor: x_mm -40.32 to 40.32",
    ]);
    let first = |answer: &str| -> Vec<String> {
        let cells = answer
            .lines()
            .skip(1)
            .map(|line| line.split(',').next().unwrap().to_owned());
        cells.collect()
    };
    let skipped = run(POINTS, &["--off-sensor", "skip"]).ok().stdout;
    assert_eq!(first(&skipped), ["a", "d"]);
    let marked = run(POINTS, &["--off-sensor", "flag"]).ok().stdout;
    assert_eq!(first(&marked), ["a", "b", "c", "d"]);
    let lines: Vec<&str> = marked.lines().collect();
    assert!(lines[0].ends_with(",sigma_y_um,flag"));
    assert_eq!(lines[2], "b,5,,,,,,,refused: not at speed");
    assert_eq!(lines[3], "c,2,,,,,,,off sensor");
    assert!(lines[1].ends_with(','));
    // The points with an answer have the same one.
    let with_flag = |line: &str| format!("{line},");
    let lines: Vec<String> = skipped.lines().skip(1).map(with_flag).collect();
    assert!(lines.iter().all(|line| marked.contains(line)));
}

#[test]
fn points_without_a_frame_are_refused_by_line_column_and_value() {
    let flight = flight();
    for (points, words) in [
        ("", "points.csv, line 1: the file is empty"),
        (
            "id,x_mm,y_mm\na,1,2\n",
            "points.csv, line 1: column sequence, frame or image is missing",
        ),
        (
            "sequence,x_mm\n1,2\n",
            "points.csv, line 1: column y_mm is missing",
        ),
        (
            "sequence,x_mm,y_mm,x_mm\n",
            "points.csv, line 1: column x_mm appears twice",
        ),
        (
            "sequence,x_mm,y_mm,col_px,row_px\n",
            "both x_mm,y_mm and col_px,row_px are given",
        ),
        (
            "image,x_mm,y_mm\nIMG,2,3\n",
            "line 1: column image: the frames have no images; --images",
        ),
        (
            "sequence,x_mm,y_mm\n9,2,3\n",
            "line 2: sequence = 9: records.csv has no such frame; its sequence numbers are 1 to 8",
        ),
        (
            "sequence,x_mm,y_mm\n1.5,2,3\n",
            "line 2: sequence = \"1.5\" is not a whole number",
        ),
        (
            "frame,x_mm,y_mm\nIMG,2,3\n",
            "line 2: frame = IMG: records.csv has no such frame",
        ),
        (
            "sequence,x_mm,y_mm\n1,nan,3\n",
            "line 2: x_mm = \"nan\" is not a finite number",
        ),
        (
            "sequence,x_mm,y_mm\n1,2\n",
            "line 2: 2 columns where the header has 3",
        ),
    ] {
        fs::write(flight.bench.path("points.csv"), points).unwrap();
        let arguments = [&["correct"], &RECORDS[..], &["points.csv"]].concat();
        flight.bench.run(&arguments).refused(&[words]);
    }
}

#[test]
fn requests_that_contradict_records_are_refused() {
    let flight = flight();
    fs::write(flight.bench.path("points.csv"), POINTS).unwrap();
    let run = |more: &[&str]| {
        let arguments = [&["correct"], &RECORDS[..], more, &["points.csv"]].concat();
        flight.bench.run(&arguments)
    };
    run(&["--vh", "0.1"]).refused(&["--records <FILE>' cannot be used with '--vh"]);
    run(&["--focus-shift-um", "3"]).refused(&["--records", "--focus-shift-um"]);
    run(&["--frames", "records.csv"]).refused(&["--records", "--frames"]);
    run(&["--device", "qemu"])
        .refused(&["--device: frames of a flight are computed in this program"]);
    run(&["--out", "answer.npy"])
        .refused(&["--out answer.npy: answers of frames have the format of the points"]);
    run(&["--out", "records.csv"]).refused(&["--out would replace records.csv"]);
    run(&["--out", "camera.toml"]).refused(&["--out camera.toml is the camera file itself"]);
    fs::write(flight.bench.path("more.csv"), "sequence,image\n1,a\n9,b\n").unwrap();
    run(&["--images", "more.csv"]).refused(&["more.csv: sequence 9 is not in records.csv"]);
    let single = [
        "correct",
        "--camera",
        "camera.toml",
        "--vh",
        "0.1",
        "--exposure",
        "1/200",
    ];
    let without = [&single[..], &["--answer", "ideal-shifted", "points.csv"]].concat();
    flight.bench.run(&without).refused(&["--records <FILE>"]);
    let printed = "frame,vh,exposure,focus_shift_um,focus_sign\n1,0.1,1/200,5,printed\n2,0.1,1/200,5,\n3,0.1,1/200,,\n5,0.1,1/200,,\n";
    fs::write(flight.bench.path("frames.csv"), printed).unwrap();
    let table = [
        "correct",
        "--camera",
        "camera.toml",
        "--frames",
        "frames.csv",
    ];
    let shifted = [
        &table[..],
        &[
            "--answer",
            "measured-shifted",
            "--off-sensor",
            "skip",
            "points.csv",
        ],
    ];
    flight.bench.run(&shifted.concat()).refused(&[
        "points.csv, line 2: frame 1: --answer measured-shifted: not defined with the printed signs",
    ]);
}

#[test]
fn records_of_another_calibration_are_refused_before_a_point_is_read() {
    let flight = flight();
    fs::write(flight.bench.path("points.csv"), POINTS).unwrap();
    let camera = fs::read_to_string(flight.bench.path("camera.toml")).unwrap();
    fs::write(
        flight.bench.path("camera.toml"),
        camera.replace("k1 = -1.0e-6", "k1 = -1.1e-6"),
    )
    .unwrap();
    for command in ["correct", "distort", "frame"] {
        let mut arguments = [&[command], &RECORDS[..]].concat();
        if command != "frame" {
            arguments.push("points.csv");
        }
        flight.bench.run(&arguments).refused(&[
            "records.csv, line 2: calibration_crc32 = ",
            "another calibration than camera.toml",
        ]);
    }
}
