//! Wrong point files.

use crate::command_line::support::{Bench, CAMERA};

fn refused(points: &[u8], words: &[&str]) {
    let bench = Bench::with(CAMERA, points);
    for command in ["correct", "distort", "reference"] {
        let answer = bench.points(command, &["--out", "out.csv"]);
        answer.refused(words);
        answer.refused(&["points.csv"]);
        assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
    }
}

#[test]
fn header_faults_are_named() {
    refused(b"", &["empty"]);
    refused(b"\n\n", &["empty"]);
    refused(b"id,x_mm\n1,2\n", &["y_mm is missing", "line 1"]);
    refused(b"x_mm,y_mm\n1,2\n", &["id is missing"]);
    refused(b"id,x,y\n1,2,3\n", &["x_mm and y_mm", "id,x,y"]);
    refused(b"1,2,3\n4,5,6\n", &["id is missing"]);
    refused(b"id,x_mm,y_mm,x_mm\n1,2,3,4\n", &["x_mm appears twice"]);
    refused(b"id,x_mm,y_mm,col_px,row_px\n1,2,3,4,5\n", &["both"]);
}

#[test]
fn row_faults_are_named_with_their_line() {
    refused(b"id,x_mm,y_mm\na,1,2\nb,3\n", &["line 3", "2 columns", "3"]);
    refused(
        b"id,x_mm,y_mm\na,1,2\nb,3,4,5\n",
        &["line 3", "4 columns", "3"],
    );
    refused(
        b"id,x_mm,y_mm\na,1,2\nb,three,4\n",
        &["line 3", "x_mm", "three", "point b"],
    );
    refused(b"id,x_mm,y_mm\na,1,NaN\n", &["line 2", "y_mm", "NaN"]);
    refused(b"id,x_mm,y_mm\na,inf,1\n", &["line 2", "x_mm", "inf"]);
    refused(b"id,x_mm,y_mm\na,1,\n", &["line 2", "y_mm"]);
    refused(b"id,x_mm,y_mm\na,1,1e400\n", &["line 2", "1e400"]);
    refused(b"id,x_mm,y_mm\na,\"1,5\",2\n", &["line 2", "x_mm", "1,5"]);
}

#[test]
fn binary_content_is_refused() {
    refused(&[0, 1, 2, 255, 254, b'\n', 7], &["line 1"]);
    refused(
        b"id,x_mm,y_mm\na,\xff\xfe,2\n",
        &["line 2", "x_mm", "UTF-8"],
    );
    refused(
        b"id,x_mm,y_mm\na\x00b,1,2\n",
        &["line 2", "id", "control character"],
    );
}

#[test]
fn point_off_the_sensor_is_refused_with_the_extent() {
    // Half the sensor is 40.32 mm, or 9215.5 px.
    for command in ["correct", "reference"] {
        let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,2\nout,40.3200001,0\n");
        bench.points(command, &[]).refused(&[
            "line 3",
            "point out",
            "x_mm = 40.3200001",
            "-40.32 to 40.32",
        ]);
        let bench = Bench::with(CAMERA, b"id,col_px,row_px\nout,0,9215.51\n");
        bench
            .points(command, &[])
            .refused(&["line 2", "row_px", "9215.5"]);
    }
}

#[test]
fn ideal_point_without_a_measured_one_is_refused() {
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,2\nfar,45,0\n");
    bench.points("distort", &[]).refused(&[
        "line 3",
        "point far",
        "off the sensor",
        "-40.32 to 40.32",
    ]);
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,2\nfar,1e30,0\n");
    bench
        .points("distort", &[])
        .refused(&["line 3", "point far"]);
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\nfar,1e300,0\n");
    bench
        .points("distort", &[])
        .refused(&["line 2", "point far"]);
}

#[test]
fn missing_point_file_is_refused() {
    let bench = Bench::new();
    std::fs::remove_file(bench.path("points.csv")).unwrap();
    bench
        .points("correct", &[])
        .refused(&["points.csv", "No such file"]);
    std::fs::create_dir(bench.path("points.csv")).unwrap();
    bench.points("correct", &[]).refused(&["points.csv"]);
}

#[test]
fn line_of_a_point_in_a_later_batch_is_named() {
    let mut points = String::from("id,x_mm,y_mm\n");
    points.push_str(&"a,1,2\n".repeat(5000));
    points.push_str("far,45,0\n");
    Bench::with(CAMERA, points.as_bytes())
        .points("distort", &[])
        .refused(&["line 5002", "point far"]);
}

#[test]
fn other_separators_are_answered_with_the_right_one() {
    for points in ["id;x_mm;y_mm\na;1;2\n", "id\tx_mm\ty_mm\na\t1\t2\n"] {
        refused(points.as_bytes(), &["id is missing", "separated by commas"]);
    }
}
