//! Exterior orientations of the frames of a flight.

use std::fmt::Write as _;
use std::fs;

use super::flight::{Flight, RECORDS, flight};
use crate::command_line::support::Answer;

/// Seconds of the GPS week at `UNIX_US`, when the camera's clock started: UTC and 18 leap seconds.
const START_S: f64 = 137_618.0;

/// A flight with 70 m/s along y, as a table of 10 Hz from 0.5 s to 8.5 s.
fn table(sigma: bool) -> String {
    let mut text = String::from("gps_seconds_of_week,x_m,y_m,z_m,roll_deg,pitch_deg,heading_deg");
    if sigma {
        text += ",sigma_x_m,sigma_y_m,sigma_z_m,sigma_pitch_deg,sigma_roll_deg,sigma_yaw_deg";
    }
    for index in 0..=80 {
        let t = 0.5 + f64::from(index) / 10.0;
        // The heading turns over at 5 s.
        let heading = (359.5 + 0.1 * t).rem_euclid(360.0);
        let [time, y] = [START_S + t, 70.0 * t];
        write!(text, "\n{time},600000,{y},1500.25,1.5,-0.25,{heading}").unwrap();
        if sigma {
            text += ",0.03,0.04,0.05,0.003,0.004,0.006";
        }
    }
    text + "\n"
}

/// An SBET file in one place.
fn sbet() -> Vec<u8> {
    let records = (0..2000).flat_map(|index| {
        let mut record = [0.0; 17];
        record[0] = START_S + f64::from(index) / 200.0;
        record[1] = 47.6_f64.to_radians();
        record[2] = 8.4_f64.to_radians();
        record[3] = 1650.0;
        // A heading of 90° with a wander angle.
        record[9] = 2.0 + std::f64::consts::FRAC_PI_2;
        record[10] = 2.0;
        record
    });
    records.flat_map(f64::to_le_bytes).collect()
}

pub(super) fn run(flight: &Flight, arguments: &[&str]) -> Answer {
    let (command, more) = arguments.split_first().unwrap();
    flight
        .bench
        .run(&[&[*command], &RECORDS[..], more].concat())
}

/// An accuracy file of 1 Hz for [`sbet`], from a second after the start of the clock on.
pub(super) fn smrmsg(from_s: f64, records: u32) -> Vec<u8> {
    let records = (0..records).flat_map(|index| {
        let time = START_S + from_s + f64::from(index);
        // North, east, down; velocity; roll, pitch, heading in minutes of arc.
        [time, 0.02, 0.03, 0.05, 0.0, 0.0, 0.0, 0.3, 0.6, 1.2]
    });
    records.flat_map(f64::to_le_bytes).collect()
}

pub(super) fn flown() -> Flight {
    let flight = flight();
    fs::write(flight.bench.path("table.csv"), table(true)).unwrap();
    fs::write(flight.bench.path("plain.csv"), table(false)).unwrap();
    fs::write(flight.bench.path("sbet.out"), sbet()).unwrap();
    flight
}

#[test]
fn frame_lists_place_and_angles_at_the_centroid_with_their_sigma() {
    let flight = flown();
    let listed = run(&flight, &["frame", "--trajectory", "table.csv"])
        .ok()
        .stdout;
    let mut rows = csv::Reader::from_reader(listed.as_bytes());
    let names = rows.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 8);
    let cell = |row: usize, name: &str| {
        let place = names.iter().position(|one| one == name);
        rows[row][place.unwrap_or_else(|| panic!("{name}"))].to_owned()
    };
    for (row, sequence) in (1..=8).enumerate() {
        let number = |name: &str| cell(row, name).parse::<f64>().unwrap();
        assert_eq!(cell(row, "latitude_deg"), "");
        if sequence == 5 {
            assert_eq!([cell(row, "x_m"), cell(row, "no_orientation")], ["", ""]);
            continue;
        }
        let t = f64::from(sequence);
        for (name, expected) in [
            ("x_m", 600_000.0),
            ("y_m", 70.0 * t),
            ("z_m", 1500.25),
            ("roll_deg", 1.5),
            ("pitch_deg", -0.25),
            ("yaw_deg", 0.5 - 0.1 * t),
            ("vx_m_s", 0.0),
            ("vy_m_s", 70.0),
            ("sigma_x_m", 0.03),
            // 70 m/s in 2 µs are 0.14 mm.
            ("sigma_y_m", 0.04),
            ("time_sigma_m", 0.000_14),
            ("sigma_pitch_deg", 0.003),
            ("sigma_roll_deg", 0.004),
            ("sigma_yaw_deg", 0.006),
            ("interpolation_sigma_m", 0.0),
        ] {
            let found = number(name);
            assert!(
                (found - expected).abs() < 2e-6,
                "{sequence} {name}: {found} {expected}"
            );
        }
    }
    let json = run(&flight, &["frame", "--json", "--trajectory", "plain.csv"])
        .ok()
        .stdout;
    let lines: Vec<serde_json::Value> = json
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines[3]["y_m"], 280.0);
    assert_eq!(lines[3]["principal_distance_mm"], 100.0);
    assert!(lines[3]["sigma_y_m"].is_null());
    assert!(lines[4]["y_m"].is_null());
}

#[test]
fn table_of_orientations_is_that_of_the_bundle_and_goes_with_points_and_exports() {
    let flight = flown();
    fs::write(
        flight.bench.path("points.csv"),
        "id,sequence,x_mm,y_mm\na,1,1,2\n",
    )
    .unwrap();
    let origin = ["--origin", "47.5,8.25,450"];
    let sigma = ["--trajectory-sigma", "0.02,0.02,0.03,0.002,0.002,0.005"];
    let asked = [&["--trajectory", "sbet.out"], &origin[..], &sigma].concat();
    let table = [
        "--orientation",
        "correct.csv",
        "points.csv",
        "--out",
        "answers.csv",
    ];
    let answer = run(&flight, &[&["correct"], &asked[..], &table].concat()).ok();
    assert!(
        answer.stderr.contains("sbet.out states no week"),
        "{}",
        answer.stderr
    );
    assert!(flight.bench.path("answers.csv").is_file());
    run(
        &flight,
        &[
            &["frame"],
            &asked[..],
            &["--orientation", "frame.csv", "--images", "images.csv"],
        ]
        .concat(),
    )
    .ok();
    run(
        &flight,
        &[
            &["export", "frames"],
            &asked[..],
            &["--out", "block", "--image-name", "{sequence:02}.tif"],
        ]
        .concat(),
    )
    .ok();
    let read = |name: &str| fs::read_to_string(flight.bench.path(name)).unwrap();
    let [correct, frame, export] = ["correct.csv", "frame.csv", "block/orientation.csv"].map(read);
    let lines: Vec<&str> = correct.lines().collect();
    assert_eq!(
        lines[0],
        "image,x_m,y_m,z_m,pitch_deg,roll_deg,yaw_deg,sigma_x_m,sigma_y_m,sigma_z_m,\
         sigma_pitch_deg,sigma_roll_deg,sigma_yaw_deg,vx_m_s,vy_m_s,vz_m_s"
    );
    // Of seven exposures; the place is that of PROJ about the origin.
    assert_eq!(lines.len(), 8);
    let first: Vec<&str> = lines[1].split(',').collect();
    assert_eq!(first[0], "1");
    for (found, expected) in first[1..4]
        .iter()
        .zip([11_282.957_710, 11_131.919_545, 1_180.317_001])
    {
        let found: f64 = found.parse().unwrap();
        assert!((found - expected).abs() < 2e-6, "{found} {expected}");
    }
    let yaw: f64 = first[6].parse().unwrap();
    // Heading 90° and the convergence of the meridians, 0.15°·sin 47.5°.
    assert!(
        (yaw + 90.0 - 0.15 * 47.5_f64.to_radians().sin()).abs() < 1e-3,
        "{yaw}"
    );
    for (other, image) in [(frame, "\"IMG, 001.tif\""), (export, "01.tif")] {
        let line = other.lines().nth(1).unwrap();
        assert_eq!(line, lines[1].replacen('1', image, 1));
        assert_eq!(other.lines().count(), 8);
    }
    // Without σ there are no columns of σ.
    let plain = [
        "--trajectory",
        "plain.csv",
        "--orientation",
        "plain-table.csv",
    ];
    run(&flight, &[&["frame"], &plain[..]].concat()).ok();
    assert_eq!(
        read("plain-table.csv").lines().next(),
        Some("image,x_m,y_m,z_m,pitch_deg,roll_deg,yaw_deg,vx_m_s,vy_m_s,vz_m_s")
    );
}

#[test]
fn exposures_that_a_trajectory_does_not_cover_are_refused_or_left_out() {
    let flight = flown();
    let short: String = table(false)
        .lines()
        .take(60)
        .fold(String::new(), |text, line| text + line + "\n");
    fs::write(flight.bench.path("short.csv"), short).unwrap();
    let short = ["frame", "--trajectory", "short.csv"];
    let whole = [&short[..], &["--out", "list.csv"]].concat();
    run(&flight, &whole).refused(&[
        "--trajectory: frame 7: its centroid at",
        "is outside the trajectory",
        "--off-trajectory skip",
    ]);
    assert!(!flight.bench.path("list.csv").exists());
    let skip = [
        &short[..],
        &["--off-trajectory", "skip", "--orientation", "some.csv"],
    ]
    .concat();
    let skipped = run(&flight, &skip).ok();
    assert!(
        skipped.stderr.contains(
            "note: 2 of 7 exposures have no orientation; the first is frame 7: its centroid at"
        ),
        "{}",
        skipped.stderr
    );
    assert!(
        skipped
            .stdout
            .lines()
            .nth(8)
            .unwrap()
            .contains("s of the week (GPS) is outside")
    );
    let some = fs::read_to_string(flight.bench.path("some.csv")).unwrap();
    assert_eq!(some.lines().count(), 6);
}

#[test]
fn requests_that_contradict_the_trajectory_are_refused() {
    let flight = flown();
    for (arguments, fault) in [
        (
            &[
                "frame",
                "--trajectory",
                "sbet.out",
                "--orientation",
                "a.csv",
            ][..],
            "--origin LAT,LON,H is missing",
        ),
        (
            &["frame", "--trajectory", "table.csv", "--origin", "1,2,3"],
            "has the coordinates x_m, y_m and z_m already",
        ),
        (
            &["correct", "--trajectory", "table.csv", "points.csv"],
            "--orientation FILE.csv is missing",
        ),
        (
            &[
                "frame",
                "--trajectory",
                "table.csv",
                "--trajectory-time",
                "utc",
            ],
            "--trajectory-time: the columns",
        ),
        (
            &[
                "frame",
                "--trajectory",
                "table.csv",
                "--orientation",
                "table.csv",
            ],
            "would replace table.csv",
        ),
        (
            &[
                "frame",
                "--trajectory",
                "table.csv",
                "--orientation",
                "records.csv",
            ],
            "would replace records.csv",
        ),
        (
            &[
                "frame",
                "--trajectory",
                "table.csv",
                "--orientation",
                "a.csv",
                "--out",
                "a.csv",
            ],
            "name the same file",
        ),
        (
            &["frame", "--trajectory", "camera.toml"],
            "one column of time is needed",
        ),
        (
            &["frame", "--trajectory", "missing.csv"],
            "missing.csv: cannot be read",
        ),
    ] {
        run(&flight, arguments).refused(&[fault]);
        assert!(!flight.bench.path("a.csv").exists());
    }
    flight
        .bench
        .run(&[
            "frame",
            "--camera",
            "camera.toml",
            "--vh",
            "0.1",
            "--exposure",
            "1/200",
            "--trajectory",
            "table.csv",
        ])
        .refused(&["--records"]);
}
