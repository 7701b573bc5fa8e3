//! Frames and requests that are refused, with file and field; nothing of a frame is left.

use std::fs::{self, File};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, SystemTime};

use super::scene::{read, scene};
use crate::command_line::frames::flight::Flight;
use crate::command_line::support::Answer;

fn rectify(flight: &Flight, more: &[&str]) -> Answer {
    let mut arguments = vec!["rectify", "--camera", "camera.toml"];
    arguments.extend(["--records", "records.csv", "--out", "out"]);
    arguments.extend(more);
    flight.bench.run(&arguments)
}

/// Checks that the output folder has not been left behind.
fn holds_nothing(flight: &Flight) {
    assert!(!flight.bench.path("out").exists());
}

#[test]
fn bytes_that_are_no_frame_are_refused() {
    let flight = scene();
    let whole = fs::read(flight.bench.path("f1.tif")).unwrap();
    let cut = &whole[..whole.len() / 2];
    for (bytes, words) in [
        (&b""[..], ["f1.tif", "empty"]),
        (b"P5 300 220 255 ", ["f1.tif", "not a TIFF"]),
        (cut, ["f1.tif", "byte"]),
    ] {
        fs::write(flight.bench.path("f1.tif"), bytes).unwrap();
        rectify(&flight, &["f1.tif"]).refused(&words);
        holds_nothing(&flight);
    }
    fs::remove_file(flight.bench.path("f1.tif")).unwrap();
    rectify(&flight, &["f1.tif"]).refused(&["f1.tif", "cannot be read"]);
    fs::create_dir(flight.bench.path("f1.tif")).unwrap();
    rectify(&flight, &["f1.tif"]).refused(&["f1.tif", "folder"]);
    holds_nothing(&flight);
}

#[test]
fn frame_of_another_size_is_refused() {
    let flight = scene();
    for (width, height, words) in [
        (200_u32, 220_u32, ["f1.tif", "200 x 220 px", "300 x 220 px"]),
        (220, 300, ["f1.tif", "220 x 300 px", "turned by 90°"]),
    ] {
        let file = fs::File::create(flight.bench.path("f1.tif")).unwrap();
        let mut encoder = tiff::encoder::TiffEncoder::new(file).unwrap();
        let samples = vec![0_u16; (width * height) as usize];
        encoder
            .write_image::<tiff::encoder::colortype::Gray16>(width, height, &samples)
            .unwrap();
        rectify(&flight, &["f1.tif"]).refused(&words);
        holds_nothing(&flight);
    }
}

#[test]
fn records_that_do_not_fit_are_refused() {
    let flight = scene();
    fs::copy(flight.bench.path("f1.tif"), flight.bench.path("f99.tif")).unwrap();
    rectify(&flight, &["f99.tif"]).refused(&["f99.tif", "records.csv has no record 99"]);
    let records = fs::read_to_string(flight.bench.path("records.csv")).unwrap();
    let line: Vec<&str> = records.lines().collect();
    for (text, words) in [
        (
            format!("{records}{}\n", line[1]),
            vec!["records.csv", "sequence", "1"],
        ),
        (
            records.replacen("0.02,", "NaN,", 1),
            vec!["records.csv", "principal_point_x_mm", "NaN"],
        ),
        (
            records.replacen("0.02,", "0.03,", 1),
            vec!["records.csv", "principal_point_x_mm", "0.03"],
        ),
    ] {
        assert_ne!(text, records);
        fs::write(flight.bench.path("records.csv"), &text).unwrap();
        rectify(&flight, &["f1.tif"]).refused(&words);
        holds_nothing(&flight);
    }
    fs::write(flight.bench.path("records.csv"), &records).unwrap();
    let camera = fs::read_to_string(flight.bench.path("camera.toml")).unwrap();
    let other = camera.replace("p1 = 2.0e-5", "p1 = 3.0e-5");
    fs::write(flight.bench.path("camera.toml"), other).unwrap();
    rectify(&flight, &["f1.tif"]).refused(&["records.csv", "another calibration"]);
    holds_nothing(&flight);
}

#[test]
fn requests_that_contradict_themselves_are_refused() {
    let flight = scene();
    let before = fs::read(flight.bench.path("f1.tif")).unwrap();
    let one = ["rectify", "--camera", "camera.toml", "--out", "out"];
    let exposure = ["--vh", "0.1", "--exposure", "1/200"];
    let run = |more: &[&str]| flight.bench.run(&[&one[..], more].concat());
    rectify(&flight, &["frame.tif"]).refused(&["frame.tif", "no number ends the name"]);
    rectify(&flight, &["f1.tif", "./f1.tif"]).refused(&["f1.tif", "both"]);
    run(&[&exposure[..], &["f1.tif", "f2.tif"]].concat()).refused(&["2 frames", "--records"]);
    for (option, value) in [
        ("--window", "300"),
        ("--window", "0x10"),
        ("--tile", "100"),
        ("--strip", "0"),
        ("--shard", "4/3"),
        ("--threads", "0"),
        ("--compression", "jpeg"),
    ] {
        rectify(&flight, &[option, value, "f1.tif"]).refused(&[option, value]);
    }
    let in_place = [
        "rectify",
        "--camera",
        "camera.toml",
        "--out",
        ".",
        "--vh",
        "0.1",
    ];
    let answer = flight
        .bench
        .run(&[&in_place[..], &["--exposure", "1/200", "f1.tif"]].concat());
    answer.refused(&["f1.tif", "another folder"]);
    assert_eq!(before, fs::read(flight.bench.path("f1.tif")).unwrap());
    holds_nothing(&flight);
}

#[test]
fn output_takes_the_place_of_no_input() {
    let flight = scene();
    let path = |name: &str| flight.bench.path(name);
    let camera = fs::read(path("camera.toml")).unwrap();
    fs::create_dir(path("in")).unwrap();
    fs::write(path("in/rectified-camera.toml"), &camera).unwrap();
    fs::copy(path("records.json"), path("in/f1.json")).unwrap();
    let run = |more: &[&str]| {
        let exposure = ["--out", "in", "f1.tif"];
        flight.bench.run(&[&["rectify"], more, &exposure].concat())
    };
    run(&[
        "--camera",
        "in/rectified-camera.toml",
        "--records",
        "records.csv",
    ])
    .refused(&["in/rectified-camera.toml", "another folder"]);
    run(&["--camera", "camera.toml", "--records", "in/f1.json"])
        .refused(&["in/f1.json", "another folder"]);
    assert_eq!(camera, fs::read(path("in/rectified-camera.toml")).unwrap());
}

#[test]
fn frames_of_a_table_with_one_output_are_refused_even_if_one_is_chosen() {
    let flight = scene();
    for folder in ["a", "b"] {
        fs::create_dir(flight.bench.path(folder)).unwrap();
        let frame = flight.bench.path(&format!("{folder}/f.tif"));
        fs::copy(flight.bench.path("f1.tif"), frame).unwrap();
    }
    let table = "file,sequence\na/f.tif,1\nb/f.tif,2\n";
    fs::write(flight.bench.path("frames.csv"), table).unwrap();
    rectify(&flight, &["--frames", "frames.csv", "a/f.tif"])
        .refused(&["a/f.tif", "b/f.tif", "f.tif"]);
    holds_nothing(&flight);
}

#[cfg(unix)]
#[test]
fn pipe_is_no_frame() {
    let flight = scene();
    fs::remove_file(flight.bench.path("f1.tif")).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(flight.bench.path("f1.tif"))
        .status();
    assert!(made.unwrap().success());
    rectify(&flight, &["f1.tif"]).refused(&["f1.tif", "must be a file"]);
    holds_nothing(&flight);
}

#[test]
fn principal_point_off_the_sensor_is_refused() {
    let flight = scene();
    let camera = fs::read_to_string(flight.bench.path("camera.toml")).unwrap();
    let other = camera.replace("[0.02, -0.01]", "[0.02, 4.3]");
    fs::write(flight.bench.path("camera.toml"), other).unwrap();
    let exposure = [
        "--vh",
        "0.1",
        "--exposure",
        "1/200",
        "--opening-offset-mm",
        "0.3",
    ];
    let more = [
        "rectify",
        "--camera",
        "camera.toml",
        "--out",
        "out",
        "f1.tif",
    ];
    let answer = flight.bench.run(&[&more[..], &exposure].concat());
    answer.refused(&["f1.tif", "principal point (0.02", "±4.4 mm"]);
    holds_nothing(&flight);
}

#[test]
fn earlier_output_outlives_a_frame_that_fails() {
    let flight = scene();
    rectify(&flight, &["f1.tif"]).ok();
    let [image, description] = ["out/f1.tif", "out/f1.json"].map(|name| flight.bench.path(name));
    let before = [&image, &description].map(|path| fs::read(path).unwrap());
    let frame = fs::read(flight.bench.path("f1.tif")).unwrap();
    fs::write(flight.bench.path("f1.tif"), &frame[..frame.len() - 600]).unwrap();
    let answer = rectify(&flight, &["f1.tif"]);
    assert_eq!(answer.code, 2, "{}", answer.stderr);
    assert_eq!(
        before,
        [&image, &description].map(|path| fs::read(path).unwrap())
    );
    read(&image);
}

/// A limit for the size of files stands for a full disk.
#[cfg(target_os = "linux")]
#[test]
fn full_disk_leaves_nothing() {
    let flight = scene();
    let program = assert_cmd::cargo::cargo_bin!("host-sim");
    let command = format!(
        "trap '' XFSZ; ulimit -f 100; exec '{}' rectify --camera camera.toml --records records.csv \
         --out out f1.tif",
        program.display()
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &command])
        .current_dir(flight.bench.folder())
        .output()
        .unwrap();
    Answer::new(&output).failed(3, &["f1.tif", "cannot be written"]);
    holds_nothing(&flight);
}

#[test]
fn frame_that_changes_while_it_is_read_is_refused() {
    let flight = scene();
    let frame = File::options()
        .write(true)
        .open(flight.bench.path("f1.tif"))
        .unwrap();
    let done = AtomicBool::new(false);
    let answer = thread::scope(|scope| {
        scope.spawn(|| {
            let mut time = SystemTime::now();
            while !done.load(Ordering::Relaxed) {
                time += Duration::from_millis(1);
                frame.set_modified(time).unwrap();
            }
        });
        let answer = rectify(&flight, &["f1.tif"]);
        done.store(true, Ordering::Relaxed);
        answer
    });
    answer.failed(3, &["f1.tif", "changed while it was read"]);
    holds_nothing(&flight);
}
