//! Wrong camera files: every refusal names file, line, field and the allowed values.

use crate::command_line::support::{Bench, CAMERA, POINTS};

/// Replaces one line of the camera file and returns the refusal.
fn refused(from: &str, to: &str, words: &[&str]) {
    assert!(CAMERA.contains(from), "{from:?}");
    let camera = CAMERA.replacen(from, to, 1);
    let bench = Bench::with(&camera, POINTS.as_bytes());
    for command in ["correct", "distort", "reference", "frame"] {
        let answer = bench.points(command, &["--model", "fitted"]);
        answer.refused(words);
        answer.refused(&["camera.toml"]);
    }
}

#[test]
fn unknown_and_missing_keys_are_named() {
    refused(
        "k1 = -1.0e-6",
        "k11 = -1.0e-6",
        &["k11", "line 12", "unknown field"],
    );
    refused("[limits]", "[limit]", &["limit", "unknown field"]);
    refused("name = \"Test camera\"\n", "", &["missing field", "name"]);
    refused(
        "principal_distance_mm = 100.0\n",
        "",
        &["missing field", "principal_distance_mm"],
    );
    refused("pixel_um = 8.75\n", "", &["missing field", "pixel_um"]);
    refused("width_px = 9216\n", "", &["missing field", "width_px"]);
    refused(
        "axis = \"+y\"",
        "axis = \"up\"",
        &["fmc.axis", "+y", "line 20"],
    );
    refused("name = \"Test camera\"", "name = \"\"", &["name", "empty"]);
}

#[test]
fn identity_of_the_calibration_is_checked_and_named() {
    let name = "name = \"Test camera\"";
    for (line, words) in [
        (
            "serial = \"0123456789abcdefg\"",
            &[
                "line 2: serial = \"0123456789abcdefg\" has 17 characters",
                "up to 16",
            ][..],
        ),
        (
            "serial = \"Nº 7\"",
            &[
                "line 2: serial = \"Nº 7\" holds",
                "printable ASCII",
                "' ' to '~'",
            ],
        ),
        ("serial = 5282", &["line 2: serial", "expected a string"]),
        (
            "version = -1",
            &["line 2: version = -1 is outside 0 to 4294967295"],
        ),
        (
            "version = 4294967296",
            &["line 2: version = 4294967296 is outside 0 to 4294967295"],
        ),
        ("version = 1.5", &["line 2: version"]),
    ] {
        refused(name, &format!("{name}\n{line}"), words);
    }
}

#[test]
fn wrong_types_and_syntax_are_named_with_their_line() {
    refused(
        "k1 = -1.0e-6",
        "k1 = \"small\"",
        &["distortion.k1", "line 12", "small"],
    );
    refused(
        "width_px = 9216",
        "width_px = 9216.5",
        &["sensor.width_px", "line 6"],
    );
    refused("[limits]", "[limits", &["line 31"]);
    refused(
        "vh_per_s = [0.05, 0.17]",
        "vh_per_s = [0.05]",
        &["limits.vh_per_s", "line 32"],
    );
    refused(
        "k1 = -1.0e-6",
        "k1 = -1.0e-6\nk1 = 2.0",
        &["k1", "duplicate key"],
    );
}

#[test]
fn nan_infinite_zero_and_out_of_range_numbers_are_named_with_the_range() {
    for (from, key, bad, range) in [
        (
            "principal_distance_mm = 100.0",
            "principal_distance_mm",
            &["nan", "inf", "0.0", "-100.0", "1e39"][..],
            "5 to 5000",
        ),
        (
            "exit_pupil_mm = 110.0",
            "exit_pupil_mm",
            &["nan", "0.0", "-1.0"],
            "1 to 100000",
        ),
        (
            "width_px = 9216",
            "width_px",
            &["0", "-5", "100001", "99999999999"],
            "1 to 57142",
        ),
        ("height_px = 9216", "height_px", &["0"], "1 to 57142"),
        (
            "pixel_um = 8.75",
            "pixel_um",
            &["nan", "0.0", "-8.75", "0.4", "101.0"],
            "0.5 to 100",
        ),
        (
            "acceleration_mm_s2 = 1000.0",
            "acceleration_mm_s2",
            &["nan", "0.0", "-1.0"],
            "1 to 1000000",
        ),
        (
            "settling_ms = 5.0",
            "settling_ms",
            &["nan", "-0.1", "1001.0"],
            "0 to 1000",
        ),
        (
            "stroke_mm = 4.0",
            "stroke_mm",
            &["nan", "0.0", "-4.0", "101.0"],
            "0.001 to 100",
        ),
        (
            "settling_ms = 5.0",
            "settling_ms = 5.0\njerk_mm_s3",
            &["nan", "inf", "0.5", "-1.0", "1e13"],
            "1 to 1000000000000; 0 or absent: unlimited",
        ),
        (
            "settling_ms = 5.0",
            "settling_ms = 5.0\nmax_speed_mm_s",
            &["nan", "inf", "1e-4", "-1.0", "100001.0"],
            "0.001 to 100000; 0 or absent: unlimited",
        ),
        (
            "opening_fraction = 0.2",
            "opening_fraction",
            &["nan", "-0.1", "1.1"],
            "0 to 1",
        ),
        (
            "closing_fraction = 0.1",
            "closing_fraction",
            &["nan", "-0.1", "0.9"],
            "0 to 0.8",
        ),
    ] {
        for value in bad {
            refused(
                from,
                &format!("{key} = {value}"),
                &[key.rsplit('\n').next().unwrap(), value, range, "line "],
            );
        }
    }
}

#[test]
fn coefficients_that_are_not_finite_are_named() {
    for key in [
        "k0 = 0.0",
        "k1 = -1.0e-6",
        "p1 = 1.0e-6",
        "b2 = 2.0e-5",
        "km0 = 1.0e-4",
        "pm1 = 5.0e-7",
    ] {
        let name = key.split(' ').next().unwrap();
        for value in ["nan", "inf", "-inf", "1e39"] {
            refused(
                key,
                &format!("{name} = {value}"),
                &[name, value, "finite number"],
            );
        }
    }
}

#[test]
fn pairs_and_polynomials_are_checked_number_by_number() {
    refused(
        "[0.02, -0.01]",
        "[nan, 0.0]",
        &["principal_point_mm", "-40.32 to 40.32"],
    );
    refused(
        "[0.02, -0.01]",
        "[20.0, -60.0]",
        &["principal_point_mm", "-40.32 to 40.32"],
    );
    refused("[0.05, 0.17]", "[0.17, 0.05]", &["vh_per_s", "0.17 to 10"]);
    refused(
        "[0.001, 0.02]",
        "[0.0, 0.02]",
        &["exposure_s", "0.000001 to 10"],
    );
    refused(
        "[0.0, 1.0]",
        "[0.0, nan]",
        &["flatness_um", "-1000 to 1000"],
    );
    refused(
        "[0.0, 1.0]",
        "[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]",
        &["flatness_um", "5"],
    );
    let tdi = CAMERA.replace(
        "mechanism = \"stage\"",
        "mechanism = \"tdi\"\nfirst_transfer = 1.5",
    );
    Bench::with(&tdi, POINTS.as_bytes())
        .points("correct", &[])
        .refused(&["first_transfer", "1.5", "0 to 1"]);
}

#[test]
fn ramps_of_a_uniform_shutter_are_a_contradiction() {
    refused(
        "profile = \"trapezoid\"",
        "profile = \"uniform\"",
        &["opening_fraction = 0.2", "uniform", "trapezoid"],
    );
}

#[test]
fn shutters_that_expose_row_after_row_are_refused_with_the_reason() {
    for shutter in ["focal-plane", "focal_plane", "rolling", "Rolling shutter"] {
        refused(
            "profile = \"trapezoid\"",
            &format!("profile = \"{shutter}\""),
            &[
                "shutter.profile",
                shutter,
                "row after row",
                "expected `uniform` or `trapezoid`",
                "leaf or global shutter",
                "docs/conventions.md, section 5",
            ],
        );
    }
    refused(
        "profile = \"trapezoid\"",
        "profile = \"box\"",
        &["unknown variant `box`", "`uniform` or `trapezoid`"],
    );
}

#[test]
fn polynomial_that_folds_the_image_is_refused_with_place_and_least_scale() {
    // 1 + 3·K1·r² vanishes at r = 40 mm, inside the corner at 57 mm.
    refused(
        "k1 = -1.0e-6",
        "k1 = 2.1e-4",
        &["[distortion]", "folds", "at least 0.1", "mm"],
    );
    refused(
        "km1 = -1.0e-6",
        "km1 = 2.1e-4",
        &["[fitted]", "folds", "at least 0.1"],
    );
    refused("b1 = 1.0e-5", "b1 = 1.5", &["[distortion]", "folds"]);
    // The coefficient is large as a number, but harmless over this sensor.
    let strong = CAMERA.replace("k1 = -1.0e-6", "k1 = 5.0e-5");
    Bench::with(&strong, POINTS.as_bytes())
        .points("frame", &[])
        .ok();
}

#[test]
fn coefficients_without_a_unit_are_named_where_they_fold_the_image() {
    // The help is broken into lines.
    let camera = CAMERA.replace("k1 = -1.0e-6", "k1 = -0.12");
    let bench = Bench::with(&camera, POINTS.as_bytes());
    let answer = bench.points("frame", &[]);
    answer.refused(&["[distortion]", "folds", "k1 = -0.12", "-1.2e-5"]);
    let words: Vec<&str> = answer.stderr.split_whitespace().collect();
    assert!(
        words.join(" ").contains("looks like a dimensionless"),
        "{}",
        answer.stderr
    );
}

#[test]
fn strong_distortion_is_warned_of_in_every_command_that_reads_a_camera() {
    let camera = CAMERA.replace("k1 = -1.0e-6", "k1 = -6.0e-5");
    let bench = Bench::with(&camera, POINTS.as_bytes());
    let mut answers = Vec::new();
    for command in ["correct", "distort", "reference", "frame"] {
        answers.push(bench.points(command, &[]));
    }
    answers.push(bench.run(&["budget", "--camera", "camera.toml"]));
    for answer in answers {
        let answer = answer.ok();
        for part in [
            "warning: camera.toml: [distortion] is ",
            "k1 = -6e-5 mm⁻²",
            "k1·f² = -0.6 ",
        ] {
            assert!(answer.stderr.contains(part), "{part}: {}", answer.stderr);
        }
        assert!(!answer.stdout.contains("warning"), "{}", answer.stdout);
    }
    let quiet = Bench::new().points("correct", &[]).ok();
    assert_eq!(quiet.stderr, "");
}

#[test]
fn camera_file_that_is_no_text_or_not_there_is_refused() {
    let bench = Bench::new();
    std::fs::write(bench.path("camera.toml"), [0xff, 0xfe, 0, 1]).unwrap();
    bench
        .points("correct", &[])
        .refused(&["camera.toml", "not a text file"]);
    std::fs::write(bench.path("camera.toml"), "").unwrap();
    bench
        .points("correct", &[])
        .refused(&["camera.toml", "missing field"]);
    std::fs::remove_file(bench.path("camera.toml")).unwrap();
    bench
        .points("correct", &[])
        .refused(&["camera.toml", "No such file"]);
    std::fs::create_dir(bench.path("camera.toml")).unwrap();
    bench
        .points("correct", &[])
        .refused(&["camera.toml", "directory"]);
    bench
        .run(&["verify", "--camera", "nowhere.toml"])
        .refused(&["nowhere.toml"]);
}

#[test]
fn pairs_of_three_and_numbers_of_the_mechanism_not_in_use_are_refused() {
    refused(
        "[0.02, -0.01]",
        "[0.02, -0.01, 0.0]",
        &["principal_point_mm", "3 numbers", "2"],
    );
    refused(
        "[0.05, 0.17]",
        "[0.05, 0.1, 0.17]",
        &["limits.vh_per_s", "3 numbers"],
    );
    refused(
        "[0.001, 0.02]",
        "[0.001]",
        &["limits.exposure_s", "1 numbers"],
    );
    refused(
        "mechanism = \"stage\"",
        "mechanism = \"stage\"\nfirst_transfer = 7.0",
        &["first_transfer", "7", "0 to 1"],
    );
    let tdi = CAMERA
        .replace("mechanism = \"stage\"", "mechanism = \"tdi\"")
        .replace("acceleration_mm_s2 = 1000.0", "acceleration_mm_s2 = nan");
    Bench::with(&tdi, POINTS.as_bytes())
        .points("frame", &[])
        .refused(&["acceleration_mm_s2", "1 to 1000000"]);
}

#[test]
fn focus_table_is_refused_by_line_key_and_value() {
    let lists = |temperatures: &str, shifts: &str| {
        format!("[focus]\ntemperature_c = [{temperatures}]\nfocus_shift_um = [{shifts}]\n[limits]")
    };
    let refused_lists = |temperatures: &str, shifts: &str, words: &[&str]| {
        refused("[limits]", &lists(temperatures, shifts), words);
    };
    refused_lists(
        "20, 10",
        "0, 5",
        &[
            "focus.temperature_c = [20, 10]",
            "temperature_c = 10 is outside 20",
        ],
    );
    refused_lists(
        "20, 20",
        "0, 5",
        &["temperature_c = 20 is outside 20.000002 to 100"],
    );
    refused_lists(
        "20, 1000",
        "0, 5",
        &["temperature_c = 1000 is outside", "to 100"],
    );
    refused_lists(
        "-1000, 20",
        "0, 5",
        &["temperature_c = -1000 is outside -100 to 100"],
    );
    refused_lists("20, nan", "0, 5", &["temperature_c = NaN is outside"]);
    refused_lists(
        "20, 30",
        "0, inf",
        &["focus.focus_shift_um", "focus_shift_um = inf is outside"],
    );
    // A hundredth of f, less the run-out.
    refused_lists(
        "20, 30",
        "0, 1001",
        &["focus_shift_um = 1001 is outside -", "focus.focus_shift_um"],
    );
    refused_lists("20", "0", &["has 1 rows; a focus table has 2 to 16"]);
    refused_lists("20, 30", "0", &["has 2 numbers, focus.focus_shift_um 1"]);
    let seventeen: Vec<String> = (0..17).map(|row| row.to_string()).collect();
    let seventeen = seventeen.join(", ");
    refused_lists(
        &seventeen,
        &seventeen,
        &["has 17 rows; a focus table has 2 to 16"],
    );
    refused(
        "[limits]",
        "[focus]\ntemperature_k = [1, 2]\nfocus_shift_um = [0, 5]\n[limits]",
        &["temperature_k", "unknown field"],
    );
    refused(
        "[limits]",
        "[focus]\ntemperature_c = [1, 2]\n[limits]",
        &["missing field", "focus_shift_um"],
    );
}

#[test]
fn long_values_are_not_echoed_whole() {
    let camera = CAMERA
        .replace("Test camera", &"x".repeat(100_000))
        .replace("k0 = 0.0", "k0 = nan");
    let answer = Bench::with(&camera, POINTS.as_bytes()).points("frame", &[]);
    answer.refused(&["k0", "line 11"]);
    assert!(answer.stderr.len() < 1000, "{}", answer.stderr.len());
}
