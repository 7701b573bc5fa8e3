//! Points of many frames as CSV.

use std::fmt::Write as _;
use std::fs;

use fmc_camera::geometry::sensor::SensorPoint;

use super::flight::{Flight, RECORDS, REFUSED, SIGMA_UM, flight};
use crate::command_line::support::{Bench, CAMERA, EXPOSURE};

/// Points of all frames but the refused one, each point in another frame than the one before it.
fn scattered(count: usize) -> Vec<(usize, f32, f32)> {
    let mut random = fastrand::Rng::with_seed(2);
    let frames: Vec<usize> = (1..=8).filter(|one| *one != REFUSED as usize).collect();
    (0..count)
        .map(|index| {
            let mut place = || 70.0 * (random.f32() - 0.5);
            (frames[(index * index) % frames.len()], place(), place())
        })
        .collect()
}

fn text(points: &[(usize, f32, f32)]) -> String {
    let mut text = String::from("name,y_mm,sequence,x_mm,remark\n");
    for (index, (frame, x, y)) in points.iter().enumerate() {
        let [x, y] = [*x, *y].map(f64::from);
        writeln!(text, "p{index},{y}, {frame} ,{x},\"a, \"\"b\"\"\"").unwrap();
    }
    text
}

/// Runs a command on points, and returns the answer's header and rows.
fn run(flight: &Flight, command: &str, more: &[&str], points: &str) -> (String, Vec<Vec<String>>) {
    fs::write(flight.bench.path("points.csv"), points).unwrap();
    let arguments = [&[command][..], &RECORDS, more, &["points.csv"]].concat();
    rows_of(&flight.bench.run(&arguments).ok().stdout)
}

fn rows_of(text: &str) -> (String, Vec<Vec<String>>) {
    let header = text.lines().next().unwrap().to_owned();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.records();
    let cells = rows.map(|row| row.unwrap().iter().map(str::to_owned).collect());
    (header, cells.collect())
}

fn number(cell: &str) -> f64 {
    cell.parse().unwrap()
}

#[test]
fn points_in_any_order_have_the_numbers_of_the_camera_and_keep_their_other_columns() {
    let flight = flight();
    let points = scattered(20_000);
    let (header, rows) = run(&flight, "correct", &[], &text(&points));
    assert_eq!(
        header,
        "name,y_mm,sequence,x_mm,remark,dx_um,dy_um,sigma_x_um,sigma_y_um"
    );
    assert_eq!(rows.len(), points.len());
    for (index, (row, (frame, x, y))) in rows.iter().zip(&points).enumerate() {
        let ideal = flight.corrections[frame - 1].correct(SensorPoint::new(*x, *y));
        assert_eq!(row[0], format!("p{index}"));
        assert_eq!(
            (row[2].as_str(), row[4].as_str()),
            (&*format!(" {frame} "), "a, \"b\"")
        );
        assert_eq!(row[3], format!("{:.9}", f64::from(ideal.point.x_mm)));
        assert_eq!(row[1], format!("{:.9}", f64::from(ideal.point.y_mm)));
        assert_eq!(
            row[5],
            format!("{:.6}", 1e3 * f64::from(ideal.distortion.dx_mm))
        );
        assert_eq!(
            row[6],
            format!("{:.6}", 1e3 * f64::from(ideal.distortion.dy_mm))
        );
    }
}

#[test]
fn csv_and_json_records_and_images_give_the_same_answers() {
    let flight = flight();
    let points = scattered(300);
    fs::write(flight.bench.path("points.csv"), text(&points)).unwrap();
    let answer = |more: &[&str]| {
        let camera = ["correct", "--camera", "camera.toml"];
        let arguments = [&camera[..], more, &["points.csv"]].concat();
        flight.bench.run(&arguments).ok().stdout
    };
    let csv = answer(&["--records", "records.csv"]);
    assert_eq!(answer(&["--records", "records.json"]), csv);
    let (_, numbered) = rows_of(&csv);
    for image_column in ["image", "frame"] {
        let mut named = format!("{image_column},x_mm,y_mm\n");
        for (frame, x, y) in &points {
            writeln!(named, "\"IMG, {frame:03}.tif\",{x},{y}").unwrap();
        }
        fs::write(flight.bench.path("points.csv"), named).unwrap();
        let (_, rows) = rows_of(&answer(&[
            "--records",
            "records.json",
            "--images",
            "images.csv",
        ]));
        for (row, expected) in rows.iter().zip(&numbered) {
            assert_eq!([&row[1], &row[2]], [&expected[3], &expected[1]]);
        }
    }
}

#[test]
fn table_of_exposures_has_the_answers_of_single_calls() {
    let bench = Bench::with(CAMERA, b"");
    let table = "frame,vh,exposure,opening_offset_mm,focus_shift_um\n\
                 7,0.1,1/200,,0\nx,0.1,1/200,-0.04,3.5\n8,70/700,0.004,0.1,-2\n";
    fs::write(bench.path("frames.csv"), table).unwrap();
    let points = "id,frame,x_mm,y_mm\na,x,10.0,-20.0\nb,7,-40.32,40.32\nc,8,1,2\nd,x,3,4\n";
    fs::write(bench.path("points.csv"), points).unwrap();
    let camera = ["--camera", "camera.toml", "--frames", "frames.csv"];
    let all = bench.run(&[&["correct"], &camera[..], &["points.csv"]].concat());
    let (header, all) = rows_of(&all.ok().stdout);
    assert_eq!(header, "id,frame,x_mm,y_mm,dx_um,dy_um");
    let singles: [(&[&str], &[usize]); 3] = [
        (&EXPOSURE, &[1]),
        (
            &[
                &EXPOSURE[..],
                &["--opening-offset-mm", "-0.04", "--focus-shift-um", "3.5"],
            ]
            .concat(),
            &[0, 3],
        ),
        (
            &[
                "--camera",
                "camera.toml",
                "--vh",
                "0.1",
                "--exposure",
                "0.004",
                "--opening-offset-mm",
                "0.1",
                "--focus-shift-um",
                "-2",
            ],
            &[2],
        ),
    ];
    for (exposure, places) in singles {
        let single = bench.run(&[&["correct"], exposure, &["points.csv"]].concat());
        let (_, single) = rows_of(&single.ok().stdout);
        for place in places {
            assert_eq!(all[*place][2..], single[*place][1..]);
        }
    }
    // Options hold for what the table leaves out.
    fs::write(bench.path("frames.csv"), "frame\nx\n7\n8\n").unwrap();
    let camera = ["--frames", "frames.csv", "points.csv"];
    let given = bench.run(&[&["correct"], &EXPOSURE[..], &camera].concat());
    assert_eq!(rows_of(&given.ok().stdout).1[1], all[1]);
}

#[test]
fn distort_takes_back_what_correct_answers() {
    let flight = flight();
    let points = scattered(2_000);
    for answer in ["ideal", "ideal-shifted", "measured-shifted"] {
        let more = ["--answer", answer];
        fs::write(flight.bench.path("points.csv"), text(&points)).unwrap();
        let there = [
            &["correct"],
            &RECORDS[..],
            &more,
            &["points.csv", "--out", "there.csv"],
        ];
        flight.bench.run(&there.concat()).ok();
        let there = fs::read_to_string(flight.bench.path("there.csv")).unwrap();
        let (header, back) = run(&flight, "distort", &more, &there);
        assert_eq!(
            header,
            there.lines().next().unwrap(),
            "columns are replaced"
        );
        let (_, there) = rows_of(&there);
        for ((row, there), (_, x, y)) in back.iter().zip(&there).zip(&points) {
            assert!(
                (number(&row[3]) - f64::from(*x)).abs() < 1.2e-5,
                "{row:?} {x}"
            );
            assert!(
                (number(&row[1]) - f64::from(*y)).abs() < 1.2e-5,
                "{row:?} {y}"
            );
            // The distortion is that of the same point.
            assert!((number(&row[5]) - number(&there[5])).abs() < 1e-3);
        }
    }
}

#[test]
fn shifted_points_are_those_of_the_frame_moved_by_its_centroid() {
    let flight = flight();
    let points = scattered(500);
    let coordinates = |answer: &str| {
        let (_, rows) = run(&flight, "correct", &["--answer", answer], &text(&points));
        let both = rows.iter().map(|row| [number(&row[3]), number(&row[1])]);
        both.collect::<Vec<_>>()
    };
    let ideal = coordinates("ideal");
    let shifted = coordinates("ideal-shifted");
    for ((ideal, shifted), (frame, ..)) in ideal.iter().zip(&shifted).zip(&points) {
        let centroid_mm = f64::from(flight.centroids_mm[frame - 1]);
        assert!((shifted[0] - ideal[0]).abs() < 1.1e-9, "the axis is +y");
        assert!((shifted[1] - ideal[1] + centroid_mm).abs() < 1.1e-9);
    }
    // κ = Δz/L: frame 4 has the run-out alone.
    let measured = coordinates("measured-shifted");
    let [x0, y0] = [0.02, -0.01];
    let mut largest = 0.0_f64;
    for (shifted, (frame, x, y)) in measured.iter().zip(&points) {
        let centroid_mm = f64::from(flight.centroids_mm[frame - 1]);
        let added_um = f64::from(u8::try_from(*frame).unwrap()) - 4.0;
        let enlarged = 1.0 + (added_um + centroid_mm) / 1000.0 / 110.0;
        let expected = [
            x0 + (f64::from(*x) - x0) / enlarged,
            y0 + (f64::from(*y) - y0 - centroid_mm) / enlarged,
        ];
        largest = largest.max((expected[0] - f64::from(*x)).abs());
        for (found, expected) in shifted.iter().zip(expected) {
            assert!((found - expected).abs() < 2e-9, "{found} {expected}");
        }
    }
    assert!(largest > 5e-4, "the focus shift is seen");
}

#[test]
fn sigma_is_the_change_of_the_answer_with_the_principal_point() {
    let flight = flight();
    let points: Vec<_> = scattered(100);
    let (_, rows) = run(
        &flight,
        "correct",
        &["--answer", "ideal-shifted"],
        &text(&points),
    );
    for row in &rows {
        let (x, y) = (number(&row[7]), number(&row[8]));
        // The distortion grows by up to 1 % of a displacement.
        assert!((y / SIGMA_UM - 1.0).abs() < 0.02, "{y}");
        assert!(x < 0.02 * SIGMA_UM);
    }
    // An ideal point hardly moves: by the change of the distortion alone.
    let (_, rows) = run(&flight, "correct", &[], &text(&points));
    for (row, (frame, x, y)) in rows.iter().zip(&points) {
        let jacobian = flight.corrections[frame - 1].jacobian(SensorPoint::new(*x, *y));
        let expected = [jacobian.dx_by_y, jacobian.dy_by_y].map(|one| f64::from(one).abs());
        assert!((number(&row[7]) - SIGMA_UM * expected[0]).abs() < 2e-6);
        assert!((number(&row[8]) - SIGMA_UM * expected[1]).abs() < 2e-6);
    }
}

#[test]
fn sigma_of_the_calibration_is_in_that_of_the_coordinates() {
    let flight = flight();
    let points = scattered(100);
    let stated = r#"{"parameters": ["c", "K1"], "sigma": [0.01, 1e-8], "correlations": null}"#;
    fs::write(flight.bench.path("sigma.json"), stated).unwrap();
    let more = ["--uncertainty", "sigma.json"];
    let (_, rows) = run(&flight, "correct", &more, &text(&points));
    for (row, (frame, x, y)) in rows.iter().zip(&points) {
        let correction = &flight.corrections[frame - 1];
        let centre = correction.centre();
        let [cx, cy] = [x - centre.x_mm, y - centre.y_mm].map(f64::from);
        let jacobian = correction.jacobian(SensorPoint::new(*x, *y));
        for (cell, by_centre, along) in [(7, jacobian.dx_by_y, cx), (8, jacobian.dy_by_y, cy)] {
            // D = K1·X·R², in µm.
            let by_k1 = 1e-5 * along * (cx * cx + cy * cy);
            let expected = by_k1.hypot(SIGMA_UM * f64::from(by_centre));
            assert!(
                (number(&row[cell]) - expected).abs() < 1e-6,
                "{row:?} {expected}"
            );
        }
    }
    // Frames without σ of their own have that of the calibration.
    fs::write(
        flight.bench.path("frames.csv"),
        "frame,vh,exposure\n1,0.1,1/200\n",
    )
    .unwrap();
    fs::write(
        flight.bench.path("points.csv"),
        "frame,x_mm,y_mm\n1,0.02,19.99\n",
    )
    .unwrap();
    let table = [
        "correct",
        "--camera",
        "camera.toml",
        "--frames",
        "frames.csv",
    ];
    let answer = flight
        .bench
        .run(&[&table[..], &more, &["points.csv"]].concat());
    let (header, rows) = rows_of(&answer.ok().stdout);
    assert!(header.ends_with("dy_um,sigma_x_um,sigma_y_um"));
    assert!(
        (number(&rows[0][6]) - 1e-5 * 8000.0).abs() < 1e-4,
        "{rows:?}"
    );
    fs::write(flight.bench.path("sigma.json"), stated.replace("K1", "fx")).unwrap();
    let answer = flight
        .bench
        .run(&[&table[..], &more, &["points.csv"]].concat());
    answer.refused(&["sigma.json: parameter fx is not one of"]);
}

#[test]
fn pixels_are_answered_by_pixels() {
    let flight = flight();
    let (header, rows) = run(
        &flight,
        "correct",
        &["--answer", "measured-shifted"],
        "col_px,row_px,frame\n4607.5,4607.5,4\n",
    );
    assert_eq!(
        header,
        "col_px,row_px,frame,dx_um,dy_um,sigma_x_um,sigma_y_um"
    );
    let moved_px = f64::from(flight.centroids_mm[3]) / 0.00875;
    assert!((number(&rows[0][0]) - 4607.5).abs() < 1e-4);
    assert!(
        (number(&rows[0][1]) - 4607.5 - moved_px).abs() < 1e-3,
        "{rows:?} {moved_px}"
    );
}
