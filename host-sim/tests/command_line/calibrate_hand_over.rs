//! `calibrate bundle --export`: what is handed over projects to itself, and is the truth.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;

use crate::command_line::flight_block::{Block, RunUp};
use crate::command_line::support::Bench;

const F_MM: f64 = 50.0;
const PRINCIPAL_MM: [f64; 2] = [0.12, -0.07];
const K1: f64 = -1.2e-5;
const P1: f64 = 3e-6;
const PITCH_MM: f64 = 4e-3;
const SIZE_PX: [f64; 2] = [13400.0, 10000.0];

/// The camera file starts off the truth.
const CAMERA: &str = "name = \"made\"\nprincipal_distance_mm = 50.05\n[sensor]\n\
                      width_px = 13400\nheight_px = 10000\npixel_um = 4.0\n";

type Vector = [f64; 3];
type Matrix = [Vector; 3];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// Rz(yaw)·Rx(pitch)·Ry(roll).
fn rotation([pitch, roll, yaw]: Vector) -> Matrix {
    let ((sp, cp), (sr, cr), (sy, cy)) = (pitch.sin_cos(), roll.sin_cos(), yaw.sin_cos());
    let about_z = [[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]];
    let about_x = [[1.0, 0.0, 0.0], [0.0, cp, -sp], [0.0, sp, cp]];
    let about_y = [[cr, 0.0, sr], [0.0, 1.0, 0.0], [-sr, 0.0, cr]];
    product(&product(&about_z, &about_x), &about_y)
}

/// Ideal point from the principal point, mm.
fn projected(pose: &(Vector, Vector), ground: Vector) -> [f64; 2] {
    let r = rotation(pose.1);
    let d = [0, 1, 2].map(|i| ground[i] - pose.0[i]);
    let u = [0, 1, 2].map(|j| (0..3).map(|i| r[i][j] * d[i]).sum::<f64>());
    [-F_MM * u[0] / u[2], -F_MM * u[1] / u[2]]
}

/// Distortion at a point from the principal point.
fn distortion([x, y]: [f64; 2]) -> [f64; 2] {
    let r2 = x * x + y * y;
    [
        x * K1 * r2 + P1 * (r2 + 2.0 * x * x),
        y * K1 * r2 + 2.0 * P1 * x * y,
    ]
}

struct Truth {
    poses: Vec<(Vector, Vector)>,
    points: Vec<Vector>,
}

/// Writes the files of twelve rolled, convergent images without noise.
fn files(bench: &Bench) -> Truth {
    let mut random = fastrand::Rng::with_seed(4);
    let points: Vec<Vector> = (0..60)
        .map(|_| {
            [
                4.0 * (random.f64() - 0.5),
                4.0 * (random.f64() - 0.5),
                1.2 * random.f64(),
            ]
        })
        .collect();
    let poses: Vec<(Vector, Vector)> = (0..12)
        .map(|number| {
            let around = std::f64::consts::TAU * f64::from(number) / 12.0;
            let place = [2.5 * around.cos(), 2.5 * around.sin(), 6.2];
            let roll = (place[0] / 6.2).atan();
            let pitch = -(place[1] / 6.2).atan();
            // Turned in steps of 90°; tilts follow the turn.
            let yaw = std::f64::consts::FRAC_PI_2 * f64::from(number % 4);
            let (sin, cos) = yaw.sin_cos();
            let tilt = [pitch * cos + roll * sin, roll * cos - pitch * sin];
            (place, [tilt[0], tilt[1], yaw])
        })
        .collect();
    let mut observed = "image,point,x_mm,y_mm,sigma_um\n".to_owned();
    for (image, pose) in poses.iter().enumerate() {
        for (point, ground) in points.iter().enumerate() {
            let ideal = projected(pose, *ground);
            let mut at = ideal;
            for _ in 0..60 {
                let [dx, dy] = distortion(at);
                at = [ideal[0] + dx, ideal[1] + dy];
            }
            let [x, y] = [at[0] + PRINCIPAL_MM[0], at[1] + PRINCIPAL_MM[1]];
            if x.abs() < 26.7 && y.abs() < 19.9 {
                writeln!(observed, "image_{image},p{point},{x:.12},{y:.12},1").unwrap();
            }
        }
    }
    let mut control = "point,x_m,y_m,z_m,role\n".to_owned();
    for (number, [x, y, z]) in points.iter().enumerate().step_by(4) {
        writeln!(control, "p{number},{x:.15},{y:.15},{z:.15},control").unwrap();
    }
    fs::write(bench.path("image_points.csv"), observed).unwrap();
    fs::write(bench.path("control.csv"), control).unwrap();
    Truth { poses, points }
}

fn run(bench: &Bench, more: &[&str]) -> crate::command_line::support::Answer {
    let arguments = [
        "calibrate",
        "bundle",
        "image_points.csv",
        "--points",
        "control.csv",
        "--camera",
        "camera.toml",
        "--estimate",
        "f,x0,y0,k1,p1",
    ];
    bench.run(&[&arguments, more].concat())
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Turns a vector by a unit quaternion: v + 2w·(q × v) + 2q × (q × v).
fn turned(scalar: f64, about: Vector, vector: Vector) -> Vector {
    let once = cross(about, vector);
    let twice = cross(about, once);
    [0, 1, 2].map(|axis| vector[axis] + 2.0 * (scalar * once[axis] + twice[axis]))
}

fn numbers(words: &[&str]) -> Vec<f64> {
    words.iter().map(|word| word.parse().unwrap()).collect()
}

fn lines(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with('#')).collect()
}

#[test]
fn colmap_projects_its_points_to_its_coordinates_and_to_the_truth() {
    let bench = Bench::with(CAMERA, b"");
    let truth = files(&bench);
    run(&bench, &["--out", "out", "--export", "colmap,csv"]).ok();
    let read = |name: &str| fs::read_to_string(bench.path("out").join(name)).unwrap();
    let cameras = read("cameras.txt");
    let words: Vec<&str> = lines(&cameras)[0].split(' ').collect();
    assert_eq!(words[..4], ["1", "PINHOLE", "13400", "10000"]);
    let camera = numbers(&words[4..]);
    let expected = [
        F_MM / PITCH_MM,
        F_MM / PITCH_MM,
        SIZE_PX[0] / 2.0 + PRINCIPAL_MM[0] / PITCH_MM,
        SIZE_PX[1] / 2.0 - PRINCIPAL_MM[1] / PITCH_MM,
    ];
    for (found, expected) in camera.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-4, "{camera:?}");
    }
    let points: HashMap<usize, Vec<f64>> = lines(&read("points3D.txt"))
        .iter()
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            // Mean distance of the projections, px: only rounding without noise.
            assert!(words[7].parse::<f64>().unwrap() < 1e-6, "{line}");
            (words[0].parse().unwrap(), numbers(&words[1..4]))
        })
        .collect();
    assert_eq!(points.len(), truth.points.len());
    let images = read("images.txt");
    let images = lines(&images);
    assert_eq!(images.len(), 24);
    let mut compared = 0;
    for pair in images.chunks(2) {
        let words: Vec<&str> = pair[0].split(' ').collect();
        let pose = numbers(&words[1..8]);
        let about = [pose[1], pose[2], pose[3]];
        let shift = [pose[4], pose[5], pose[6]];
        let number: usize = words[9].strip_prefix("image_").unwrap().parse().unwrap();
        // -Rᵀt is the projection centre.
        let back = turned(pose[0], about.map(|part| -part), shift);
        for (found, expected) in back.iter().zip(truth.poses[number].0) {
            assert!((-found - expected).abs() < 1e-7);
        }
        let words: Vec<&str> = pair[1].split(' ').collect();
        for triple in words.chunks(3) {
            let [col, row] = [triple[0], triple[1]].map(|word| word.parse::<f64>().unwrap());
            let place = &points[&triple[2].parse().unwrap()];
            let axes = turned(pose[0], about, [place[0], place[1], place[2]]);
            let along = [0, 1, 2].map(|axis| axes[axis] + shift[axis]);
            let found = [
                camera[0] * along[0] / along[2] + camera[2],
                camera[1] * along[1] / along[2] + camera[3],
            ];
            assert!(along[2] > 0.0);
            assert!((found[0] - col).abs() < 1e-6 && (found[1] - row).abs() < 1e-6);
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared}");
    lists_hold_the_ideal_points(&truth, &read);
}

/// The lists in mm have the corrected points of the truth, and its poses.
fn lists_hold_the_ideal_points(truth: &Truth, read: &dyn Fn(&str) -> String) {
    let mut compared = 0;
    for line in read("corrected_points.csv").lines().skip(1) {
        let words: Vec<&str> = line.split(',').collect();
        let image: usize = words[0].strip_prefix("image_").unwrap().parse().unwrap();
        let point: usize = words[1].strip_prefix('p').unwrap().parse().unwrap();
        let [x, y] = projected(&truth.poses[image], truth.points[point]);
        let found = numbers(&words[2..4]);
        assert!((found[0] - x - PRINCIPAL_MM[0]).abs() < 1e-6, "{line}");
        assert!((found[1] - y - PRINCIPAL_MM[1]).abs() < 1e-6, "{line}");
        compared += 1;
    }
    assert!(compared > 300, "{compared}");
    for (line, pose) in read("orientations.csv").lines().skip(1).zip(&truth.poses) {
        let words: Vec<&str> = line.split(',').collect();
        let found = numbers(&words[1..]);
        for (axis, (place, angle)) in pose.0.iter().zip(pose.1).enumerate() {
            assert!((found[axis] - place).abs() < 1e-7, "{line}");
            let turn = (found[3 + axis].to_radians() - angle) / std::f64::consts::TAU;
            assert!((turn - turn.round()).abs() < 1e-8, "{line}");
        }
    }
    let pinhole = read("pinhole.csv");
    assert!(
        pinhole
            .lines()
            .nth(1)
            .unwrap()
            .starts_with("made,13400,10000,4.0,50.0")
    );
}

/// Without the scale of the stage the image points would lie 2.7 px off along the strips.
#[test]
fn block_with_a_stage_scale_is_handed_over_as_it_was_adjusted() {
    let block = Block {
        run_up: RunUp::FromRest,
        seed: 1,
        fault_mm: 0.0,
        at_trigger: false,
        scale: 0.2,
    };
    let bench = block.bench();
    let files = ["--points", "points.csv", "--images", "images.csv"];
    let records = ["--camera", "camera.toml", "--records", "records.csv"];
    let more = [
        "--estimate",
        "stage_scale",
        "--out",
        "out",
        "--export",
        "colmap",
    ];
    let command = ["calibrate", "bundle", "image_points.csv"];
    bench
        .run(&[&command[..], &files, &records, &more].concat())
        .ok();
    let read = |name: &str| fs::read_to_string(bench.path("out").join(name)).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
    let all = summary["parameters"].as_array().unwrap();
    let scale = all.iter().find(|one| one["name"] == "stage_scale").unwrap();
    assert!(
        (scale["value"].as_f64().unwrap().abs() - 0.2).abs() < 0.15,
        "{scale}"
    );
    let camera = numbers(
        &lines(&read("cameras.txt"))[0]
            .split(' ')
            .collect::<Vec<_>>()[4..],
    );
    let points: HashMap<usize, Vec<f64>> = lines(&read("points3D.txt"))
        .iter()
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            (words[0].parse().unwrap(), numbers(&words[1..4]))
        })
        .collect();
    let images = read("images.txt");
    let (mut squares, mut count) = (0.0, 0.0);
    for pair in lines(&images).chunks(2) {
        let words: Vec<&str> = pair[0].split(' ').collect();
        let pose = numbers(&words[1..8]);
        let words: Vec<&str> = pair[1].split(' ').collect();
        for triple in words.chunks(3) {
            let row: f64 = triple[1].parse().unwrap();
            let place = &points[&triple[2].parse().unwrap()];
            let about = [pose[1], pose[2], pose[3]];
            let axes = turned(pose[0], about, [place[0], place[1], place[2]]);
            let [y, z] = [1, 2].map(|axis| axes[axis] + pose[4 + axis]);
            squares += (camera[1] * y / z + camera[3] - row).powi(2);
            count += 1.0;
        }
    }
    assert!(count > 1000.0, "{count}");
    // The noise of the image points is 1.128 µm, 0.3 px, of which poses and points take a part.
    let rms_px = f64::sqrt(squares / count);
    assert!((0.15..0.3).contains(&rms_px), "{rms_px} px");
}

#[test]
fn lists_are_read_again_with_the_camera_without_distortion() {
    let bench = Bench::with(CAMERA, b"");
    files(&bench);
    run(&bench, &["--out", "out", "--export", "csv"]).ok();
    let pinhole = "name = \"ideal\"\nprincipal_distance_mm = 50.0\n\
                   principal_point_mm = [0.12, -0.07]\n[sensor]\n\
                   width_px = 13400\nheight_px = 10000\npixel_um = 4.0\n";
    fs::write(bench.path("pinhole.toml"), pinhole).unwrap();
    bench
        .run(&[
            "calibrate",
            "bundle",
            "out/corrected_points.csv",
            "--points",
            "control.csv",
            "--images",
            "out/orientations.csv",
            "--camera",
            "pinhole.toml",
            "--estimate",
            "none",
            "--out",
            "again",
        ])
        .ok();
    let points = |folder: &str| {
        let path = bench.path(folder).join("points.csv");
        let text = fs::read_to_string(path).unwrap();
        let rows = text.lines().skip(1).map(|line| {
            let words: Vec<&str> = line.split(',').collect();
            (words[0].to_owned(), numbers(&words[1..4]))
        });
        rows.collect::<HashMap<_, _>>()
    };
    let (first, again) = (points("out"), points("again"));
    assert_eq!(first.len(), 60);
    for (name, place) in &first {
        for axis in 0..3 {
            assert!((place[axis] - again[name][axis]).abs() < 1e-7, "{name}");
        }
    }
}

#[test]
fn format_goes_with_a_folder() {
    let bench = Bench::with(CAMERA, b"");
    files(&bench);
    run(&bench, &["--export", "colmap"]).refused(&["--out"]);
    run(&bench, &["--export", "bingo", "--out", "out"]).refused(&["bingo", "colmap", "csv"]);
    let text = fs::read_to_string(bench.path("image_points.csv")).unwrap();
    fs::write(
        bench.path("image_points.csv"),
        text.replace("image_3,", "image 3,"),
    )
    .unwrap();
    run(&bench, &["--export", "colmap", "--out", "out"])
        .refused(&["image 3", "end a name at a space"]);
}
