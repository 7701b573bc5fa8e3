//! `export --trajectory`: exterior orientations where the formats have a place for them.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use super::trajectory::{flown, run, smrmsg};

type Matrix = [[f64; 3]; 3];

fn product(a: Matrix, b: Matrix) -> Matrix {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| (0..3).map(|k| a[row][k] * b[k][column]).sum()))
}

/// Returns Rx(ω)·Ry(φ)·Rz(κ).
fn rotation([omega, phi, kappa]: [f64; 3]) -> Matrix {
    let [(so, co), (sp, cp), (sk, ck)] =
        [omega, phi, kappa].map(|degrees| degrees.to_radians().sin_cos());
    let x = [[1.0, 0.0, 0.0], [0.0, co, -so], [0.0, so, co]];
    let y = [[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]];
    let z = [[ck, -sk, 0.0], [sk, ck, 0.0], [0.0, 0.0, 1.0]];
    product(product(x, y), z)
}

/// Returns the rotation matrix of a quaternion w, x, y, z.
fn matrix([w, x, y, z]: [f64; 4]) -> Matrix {
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

/// Returns the rows of a table by the cells of a column.
fn rows(text: &str, key: &str) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.deserialize::<BTreeMap<String, String>>();
    rows.map(|row| {
        let row = row.unwrap();
        (row[key].clone(), row)
    })
    .collect()
}

fn numbers<const N: usize>(row: &BTreeMap<String, String>, names: [&str; N]) -> [f64; N] {
    names.map(|name| {
        row[name]
            .parse()
            .unwrap_or_else(|_| panic!("{name}: {}", row[name]))
    })
}

fn close<const N: usize>(found: [f64; N], expected: [f64; N], tolerance: f64) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance, "{found} {expected}");
    }
}

/// Exports with the trajectory, and returns the text of a file.
fn exported(flight: &super::flight::Flight, format: &str, more: &[&str], file: &str) -> String {
    let out = format!("{format}-out");
    let arguments = ["export", format, "--out", &out, "--trajectory"];
    run(flight, &[&arguments, more].concat()).ok();
    fs::read_to_string(flight.bench.path(&out).join(file)).unwrap()
}

#[test]
fn poses_of_all_programs_are_one_place_and_one_rotation() {
    let flight = flown();
    let of = |format: &str, file: &str| exported(&flight, format, &["table.csv"], file);
    let arcgis = rows(&of("arcgis", "frames.csv"), "ObjectID");
    let metashape = rows(&of("metashape", "reference.csv"), "label");
    let opf: Value = serde_json::from_str(&of("opf", "calibrated_cameras.json")).unwrap();
    let images = of("colmap", "images.txt");
    assert!(images.contains("# Number of images: 7\n"));
    let mut compared = 0;
    for line in images
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
    {
        let words: Vec<&str> = line.split(' ').collect();
        let [w, x, y, z, t0, t1, t2]: [f64; 7] =
            std::array::from_fn(|index| words[index + 1].parse().unwrap());
        let camera_from_world = matrix([w, x, y, z]);
        let row = &arcgis[words[0]];
        let place = numbers(row, ["PerspectiveX", "PerspectiveY", "PerspectiveZ"]);
        let seconds: f64 = words[0].parse().unwrap();
        close(place, [600_000.0, 70.0 * seconds, 1500.25], 1e-6);
        // The projection centre is at the origin of the camera.
        let turned = camera_from_world.map(|row| {
            row.iter()
                .zip(place)
                .map(|(cell, metres)| cell * metres)
                .sum::<f64>()
        });
        close(
            [turned[0] + t0, turned[1] + t1, turned[2] + t2],
            [0.0; 3],
            1e-8,
        );
        let angles = numbers(row, ["Omega", "Phi", "Kappa"]);
        let ground_from_camera = rotation(angles);
        let sign = [1.0, -1.0, -1.0];
        for (column, sign) in sign.into_iter().enumerate() {
            let axis = [0, 1, 2].map(|row| sign * ground_from_camera[row][column]);
            close(camera_from_world[column], axis, 1e-12);
        }
        // Rz(yaw)·Rx(pitch)·Ry(roll) with pitch -0.25°, roll 1.5° and heading 359.5° + 0.1°/s.
        let yaw = 0.5 - 0.1 * seconds;
        let pitch_roll = product(rotation([-0.25, 0.0, 0.0]), rotation([0.0, 1.5, 0.0]));
        let expected = product(rotation([0.0, 0.0, yaw]), pitch_roll);
        for (found, expected) in ground_from_camera.into_iter().zip(expected) {
            close(found, expected, 1e-9);
        }
        let camera = opf["cameras"].as_array().unwrap();
        let camera = camera.iter().find(|one| one["id"] == seconds).unwrap();
        let three = |key: &str| -> [f64; 3] {
            std::array::from_fn(|index| camera[key][index].as_f64().unwrap())
        };
        // A decimal is read back within a unit in its last place.
        close(three("position"), place, 1e-9);
        close(three("orientation_deg"), angles, 1e-12);
        let reference = &metashape[words[9].trim_end_matches(".tif")];
        close(numbers(reference, ["x", "y", "z"]), place, 0.0);
        close(numbers(reference, ["omega", "phi", "kappa"]), angles, 0.0);
        close(
            numbers(reference, ["x_accuracy", "y_accuracy", "z_accuracy"]),
            [0.03, 0.04, 0.05],
            1e-6,
        );
        // Heading north, ω is pitch, φ roll and κ yaw.
        close(
            numbers(
                reference,
                ["omega_accuracy", "phi_accuracy", "kappa_accuracy"],
            ),
            [0.003, 0.004, 0.006],
            2e-4,
        );
        compared += 1;
    }
    assert_eq!(compared, 7);
    let statement = fs::read_to_string(flight.bench.path("colmap-out/export.json")).unwrap();
    let statement: Value = serde_json::from_str(&statement).unwrap();
    assert_eq!(statement["frames"]["poses"]["frames"], 7);
    assert_eq!(statement["frames"]["poses"]["has_sigma"], true);
}

#[test]
fn exposures_without_a_pose_are_left_out_of_the_poses_alone() {
    let flight = flown();
    let short: String = fs::read_to_string(flight.bench.path("plain.csv"))
        .unwrap()
        .lines()
        .take(60)
        .fold(String::new(), |text, line| text + line + "\n");
    fs::write(flight.bench.path("short.csv"), short).unwrap();
    let skip = ["short.csv", "--off-trajectory", "skip"];
    let images = exported(&flight, "colmap", &skip, "images.txt");
    assert!(images.contains("# Number of images: 5\n"));
    assert!(!images.contains("IMG_00007.tif"));
    let cameras = fs::read_to_string(flight.bench.path("colmap-out/cameras.txt")).unwrap();
    assert!(cameras.lines().any(|line| line.starts_with("7 ")));
    let arcgis = rows(
        &exported(&flight, "arcgis", &skip, "frames.csv"),
        "ObjectID",
    );
    assert_eq!(arcgis["7"]["PerspectiveX"], "");
    assert_eq!(arcgis.len(), 7);
    let binary = [&skip[..], &["--binary"]].concat();
    let arguments = ["export", "colmap", "--out", "binary", "--trajectory"];
    run(&flight, &[&arguments, &binary[..]].concat()).ok();
    let bytes = fs::read(flight.bench.path("binary/images.bin")).unwrap();
    assert_eq!(bytes[..8], 5_u64.to_le_bytes());
}

#[test]
fn geographic_places_and_the_accuracy_of_an_sbet_file_reach_the_programs_that_take_them() {
    let flight = flown();
    fs::write(flight.bench.path("smrmsg.out"), smrmsg(0.0, 10)).unwrap();
    let asked = [
        "sbet.out",
        "--trajectory-accuracy",
        "smrmsg.out",
        "--origin",
        "47.5,8.25,0",
    ];
    let metashape = exported(&flight, "metashape", &asked, "reference.csv");
    let row = &rows(&metashape, "label")["IMG_00003"];
    close(numbers(row, ["x", "y", "z"]), [8.4, 47.6, 1650.0], 1e-9);
    // σ north, east and down, and of roll, pitch and heading, of which the body heads east.
    close(
        numbers(row, ["x_accuracy", "y_accuracy", "z_accuracy"]),
        [0.03, 0.02, 0.05],
        1e-9,
    );
    close(
        numbers(row, ["omega_accuracy", "phi_accuracy", "kappa_accuracy"]),
        [0.3, 0.6, 1.2].map(|minutes| minutes / 60.0),
        1e-6,
    );
    close(
        numbers(row, ["omega", "phi", "kappa"]),
        [0.0, 0.0, -90.0],
        1e-9,
    );
    let exif = exported(&flight, "opensfm", &asked, "exif_overrides.json");
    let exif: Value = serde_json::from_str(&exif).unwrap();
    let gps = &exif["IMG_00003.tif"]["gps"];
    let number = |key: &str| gps[key].as_f64().unwrap();
    close(
        ["latitude", "longitude", "altitude", "dop"].map(number),
        [47.6, 8.4, 1650.0, 0.05],
        1e-9,
    );
    assert_eq!(exif.as_object().unwrap().len(), 7);
}

#[test]
fn accuracy_that_does_not_go_with_the_trajectory_is_refused() {
    let flight = flown();
    let of = |name: &str, bytes: &[u8]| fs::write(flight.bench.path(name), bytes).unwrap();
    of("half.out", &smrmsg(0.0, 10)[..130]);
    of("late.out", &smrmsg(4.0, 10));
    let twice = smrmsg(0.0, 3);
    of("twice.out", &[&twice[..80], &twice[..80]].concat());
    let mut angle = smrmsg(0.0, 10);
    angle[80 + 56..80 + 64].copy_from_slice(&(-1.0_f64).to_le_bytes());
    of("negative.out", &angle);
    of("smrmsg.out", &smrmsg(0.0, 10));
    for (trajectory, accuracy, fault) in [
        (
            "sbet.out",
            "half.out",
            "130 bytes are not two or more whole records of 80 bytes",
        ),
        (
            "sbet.out",
            "late.out",
            "late.out: 137619.000 s of the week is outside its times",
        ),
        (
            "sbet.out",
            "twice.out",
            "twice.out, record 2: time = 137618: must be later",
        ),
        (
            "sbet.out",
            "negative.out",
            "record 2: σ of roll = -1: must be 0 to",
        ),
        ("table.csv", "smrmsg.out", "goes with an SBET file"),
        ("sbet.out", "missing.out", "missing.out: cannot be read"),
    ] {
        let arguments = [
            "frame",
            "--trajectory",
            trajectory,
            "--trajectory-accuracy",
            accuracy,
        ];
        run(&flight, &arguments).refused(&[fault]);
    }
    let both = [
        "frame",
        "--trajectory",
        "sbet.out",
        "--trajectory-accuracy",
        "smrmsg.out",
        "--trajectory-sigma",
        "1,1,1,1,1,1",
    ];
    run(&flight, &both).refused(&["--trajectory-accuracy", "--trajectory-sigma"]);
}
