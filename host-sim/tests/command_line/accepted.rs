//! Good input, and unusual input that is accepted.

use crate::command_line::support::{Bench, CAMERA, POINTS};

#[test]
fn correct_agrees_with_the_reference_and_distort_undoes_it() {
    for more in [
        &["--vh", "0.17", "--exposure", "0.02"][..],
        &["--opening-offset-mm", "-0.04", "--focus-shift-um", "-5"],
        &["--focus-sign", "printed", "--focus-shift-um", "5"],
        &["--model", "static"],
        &["--model", "fitted"],
        &["--direction", "reverse", "--exposure", "0.02"],
        &["--direction", "reverse", "--model", "fitted"],
    ] {
        let bench = Bench::new();
        let corrected = bench.points("correct", more).ok();
        let reference = bench.points("reference", more).ok();
        assert_eq!(corrected.rows().len(), 3);
        for ((id, found), (reference_id, strict)) in
            corrected.rows().into_iter().zip(reference.rows())
        {
            assert_eq!(id, reference_id);
            // Limits: 5 nm on coordinates, 1.5 nm on distortions.
            assert!((found[0] - strict[0]).abs() < 5e-6 && (found[1] - strict[1]).abs() < 5e-6);
            assert!(
                (found[2] - strict[2]).abs() < 1.5e-3,
                "{more:?}: {found:?} {strict:?}"
            );
            assert!(
                (found[3] - strict[3]).abs() < 1.5e-3,
                "{more:?}: {found:?} {strict:?}"
            );
        }
        let back = Bench::with(CAMERA, corrected.stdout.as_bytes());
        let distorted = back.points("distort", more).ok();
        for (line, (_, row)) in POINTS.lines().skip(1).zip(distorted.rows()) {
            let mut fields = line.split(',').skip(1).map(|f| f.parse::<f64>().unwrap());
            assert!((row[0] - fields.next().unwrap()).abs() < 8e-6, "{more:?}");
            assert!((row[1] - fields.next().unwrap()).abs() < 8e-6, "{more:?}");
        }
    }
}

#[test]
fn answer_has_the_documented_header_order_and_decimals() {
    let answer = Bench::new().points("correct", &[]).ok();
    let mut lines = answer.stdout.lines();
    assert_eq!(lines.next(), Some("id,x_mm,y_mm,dx_um,dy_um"));
    let first = lines.next().unwrap();
    assert!(first.starts_with("a,"));
    let decimals: Vec<usize> = first
        .split(',')
        .skip(1)
        .map(|field| field.split('.').nth(1).unwrap().len())
        .collect();
    assert!(decimals[0] >= 7 && decimals[1] >= 7 && decimals[2] >= 5 && decimals[3] >= 5);
}

#[test]
fn pixels_in_pixels_out() {
    let points = "row_px,id,col_px\n-0.5,corner,9215.5\n4607.5,centre,4607.5\n";
    let answer = Bench::with(CAMERA, points.as_bytes())
        .points("correct", &[])
        .ok();
    assert!(answer.stdout.starts_with("id,col_px,row_px,dx_um,dy_um\n"));
    let in_mm = Bench::with(CAMERA, b"id,x_mm,y_mm\ncorner,40.32,40.32\ncentre,0,0\n")
        .points("correct", &[])
        .ok();
    for ((_, px), (_, mm)) in answer.rows().into_iter().zip(in_mm.rows()) {
        assert!((px[0] - (4607.5 + mm[0] / 0.00875)).abs() < 1e-5);
        assert!((px[1] - (4607.5 - mm[1] / 0.00875)).abs() < 1e-5);
        assert!((px[2] - mm[2]).abs() < 1e-9 && (px[3] - mm[3]).abs() < 1e-9);
    }
}

#[test]
fn byte_order_mark_crlf_missing_final_newline_and_other_columns_are_accepted() {
    let plain = Bench::new().points("correct", &[]).ok();
    for points in [
        format!("\u{feff}{POINTS}"),
        POINTS.replace('\n', "\r\n"),
        POINTS.trim_end().to_owned(),
        "y_mm , note,id, x_mm\n-20.0,\"a, b\",a,10.0\n40.32,,b, -40.32\n0,,c,0\n".to_owned(),
    ] {
        let answer = Bench::with(CAMERA, points.as_bytes())
            .points("correct", &[])
            .ok();
        assert_eq!(answer.stdout, plain.stdout, "{points:?}");
    }
}

#[test]
fn ids_come_back_as_they_were() {
    let points = "id,x_mm,y_mm\n\"a,1\",1,1\n007,2,2\n\"say \"\"x\"\"\",3,3\nПункт 4,4,4\n";
    let answer = Bench::with(CAMERA, points.as_bytes())
        .points("correct", &[])
        .ok();
    let ids: Vec<String> = answer.rows().into_iter().map(|(id, _)| id).collect();
    assert_eq!(ids, ["a,1", "007", "say \"x\"", "Пункт 4"]);
}

#[test]
fn header_without_points_gives_a_header_without_answers() {
    let answer = Bench::with(CAMERA, b"id,x_mm,y_mm\n")
        .points("correct", &[])
        .ok();
    assert_eq!(answer.stdout, "id,x_mm,y_mm,dx_um,dy_um\n");
}

#[test]
fn only_the_required_keys_make_a_camera() {
    let camera = "name = \"bare\"\nprincipal_distance_mm = 100\n\
                  [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";
    let answer = Bench::with(camera, POINTS.as_bytes())
        .points("correct", &[])
        .ok();
    assert!(
        answer
            .rows()
            .iter()
            .all(|(_, row)| row[2] == 0.0 && row[3] == 0.0)
    );
}

#[test]
fn correction_sign_reads_published_corrections() {
    let turned = CAMERA
        .replace("sign = \"distortion\"", "sign = \"correction\"")
        .replace("k1 = -1.0e-6\nk2 = 2.0e-10\nk3 = 0.0\np1 = 1.0e-6\np2 = -2.0e-6\nb1 = 1.0e-5\nb2 = 2.0e-5",
                 "k1 = 1.0e-6\nk2 = -2.0e-10\nk3 = 0.0\np1 = -1.0e-6\np2 = 2.0e-6\nb1 = -1.0e-5\nb2 = -2.0e-5");
    let answer = Bench::with(&turned, POINTS.as_bytes())
        .points("correct", &[])
        .ok();
    assert_eq!(
        answer.stdout,
        Bench::new().points("correct", &[]).ok().stdout
    );
}

#[test]
fn frame_reports_the_centroid_principal_point_for_people_and_machines() {
    let bench = Bench::new();
    let more = [
        "--vh",
        "0.1",
        "--exposure",
        "0.01",
        "--opening-offset-mm",
        "0",
    ];
    let people = bench.points("frame", &more).ok();
    assert!(people.stdout.contains("centroid principal point"));
    let machines = bench
        .points("frame", &[&more[..], &["--json"]].concat())
        .ok();
    let record: serde_json::Value = serde_json::from_str(&machines.stdout).unwrap();
    // δ = 0.1 mm; ramps of 20 and 10 %: E[τ]/t = 0.5 + 0.1·2.4/(6·1.7).
    let centroid = 0.1 * (0.5 + 0.1 * 2.4 / (6.0 * 1.7));
    let number = |key: &str| record[key].as_f64().unwrap();
    assert!((number("travel_mm") - 0.1).abs() < 1e-6);
    assert!((number("centroid_offset_mm") - centroid).abs() < 1e-6);
    let principal_point = record["principal_point_mm"].as_array().unwrap();
    assert!((principal_point[0].as_f64().unwrap() - 0.02).abs() < 1e-6);
    assert!((principal_point[1].as_f64().unwrap() - (centroid - 0.01)).abs() < 1e-6);
    // Flatness of 1 µm per mm at the centroid.
    assert!((number("focus_shift_um") - centroid).abs() < 1e-5);
    assert_eq!(record["focus_convention"], "A");
}

#[test]
fn literal_reading_is_labelled_and_counts_the_static_distortion_twice() {
    let bench = Bench::new();
    let consistent = bench.points("reference", &[]).ok();
    let literal = bench.points("reference", &["--reading", "literal"]).ok();
    assert!(literal.stderr.contains("literal"), "{}", literal.stderr);
    let (_, once) = &consistent.rows()[1];
    let (_, twice) = &literal.rows()[1];
    assert!((twice[2] / once[2] - 2.0).abs() < 0.01);
    let arc = bench.points("reference", &["--weight", "arc-length"]).ok();
    let (_, arc) = &arc.rows()[1];
    assert!((arc[2] - once[2]).abs() < 1e-3);
}

#[test]
fn tdi_needs_no_strategy_and_says_that_one_has_no_effect() {
    let tdi = CAMERA.replace(
        "mechanism = \"stage\"",
        "mechanism = \"tdi\"\nfirst_transfer = 1.0",
    );
    let noted = Bench::with(&tdi, POINTS.as_bytes())
        .points("correct", &[])
        .ok();
    assert!(noted.stderr.contains("strategy has no effect"));
    let without = tdi.replace("strategy = \"centred\"\n", "");
    let quiet = Bench::with(&without, POINTS.as_bytes())
        .points("correct", &[])
        .ok();
    assert_eq!(quiet.stderr, "");
    assert_eq!(quiet.stdout, noted.stdout);
}

#[test]
fn principal_distance_of_a_frame_has_the_digits_of_the_camera_file() {
    for distance in ["153.247", "100", "51.3712"] {
        let camera = CAMERA.replace("100.0\nexit_pupil_mm = 110.0", distance);
        let frame = Bench::with(&camera, b"").points("frame", &[]).ok();
        let line = format!("principal distance       {distance} mm\n");
        assert!(frame.stdout.contains(&line), "{}", frame.stdout);
    }
}

#[test]
fn help_names_every_command_and_exit_code() {
    let help = Bench::new().run(&["--help"]).ok();
    for word in [
        "verify",
        "correct",
        "distort",
        "reference",
        "frame",
        "sweep",
        "budget",
        "camera-file",
        "Exit codes",
    ] {
        assert!(help.stdout.contains(word), "{word}");
    }
}

#[test]
fn shipped_cameras_are_camera_files() {
    for (name, text) in fmc_camera_file::published::CAMERA_FILES {
        let bench = Bench::with(text, b"id,x_mm,y_mm\na,1,1\n");
        let frame = bench.points("frame", &[]).ok();
        assert!(frame.stdout.contains("principal distance"), "{name}");
    }
}

#[test]
fn barrel_distortion_is_negative_and_its_correction_outwards() {
    // K1 = -1e-5 moves the image at 30 mm by 0.27 mm towards the centre.
    let barrel = "name = \"barrel\"\nprincipal_distance_mm = 100.0\n\
                  [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n\
                  [distortion]\nk1 = -1e-5\n";
    let bench = Bench::with(barrel, b"id,x_mm,y_mm\na,30,0\nb,0,-30\n");
    for command in ["correct", "reference"] {
        let rows = bench.points(command, &["--model", "static"]).ok().rows();
        let (_, right) = &rows[0];
        assert!(
            (right[2] + 270.0).abs() < 1e-3 && (right[0] - 30.27).abs() < 1e-5,
            "{right:?}"
        );
        let (_, below) = &rows[1];
        assert!(
            (below[3] - 270.0).abs() < 1e-3 && (below[1] + 30.27).abs() < 1e-5,
            "{below:?}"
        );
    }
}

#[test]
fn corners_go_to_their_ideal_points_and_back_and_forth() {
    for (name, text) in fmc_camera_file::published::CAMERA_FILES {
        let (camera, _) = fmc_camera_file::CameraFile::parse(name, text).unwrap();
        let [x, y] = camera.half_format_mm();
        let corners = format!("id,x_mm,y_mm\na,{x},{y}\nb,-{x},{y}\nc,-{x},-{y}\nd,{x},-{y}\n");
        let ideal = Bench::with(text, corners.as_bytes())
            .points("correct", &[])
            .ok();
        let measured = Bench::with(text, ideal.stdout.as_bytes())
            .points("distort", &[])
            .ok();
        let again = Bench::with(text, measured.stdout.as_bytes())
            .points("correct", &[])
            .ok();
        for ((_, ideal), (_, again)) in ideal.rows().into_iter().zip(again.rows()) {
            assert!((ideal[0] - again[0]).abs() < 2e-5 && (ideal[1] - again[1]).abs() < 2e-5);
        }
    }
}
