//! Details, calibrations and forms that a certificate is made with.

use std::fmt::Write;
use std::fs;

use super::super::support::{Bench, CAMERA};
use super::bench::{ALL, DETAILS, SUMMARY, bench, content, make, pdf};

#[test]
fn missing_details_are_not_stated_and_never_invented() {
    let bench = bench();
    make(&bench, &[]).ok();
    let content = content(&bench);
    let identity = &content["identity"];
    for key in [
        "number",
        "calibrated_on",
        "issued_on",
        "valid_until",
        "procedure",
        "remarks",
    ] {
        assert!(identity[key].is_null(), "{key}");
    }
    assert!(content["parameters"]["observed"].is_null());
    let text = pdf(&bench).words().join(" ");
    for words in [
        "certificate number not stated",
        "valid until not stated",
        "lens not stated",
        "σ is that of the radial distortion at f, from those of K0 to K3 and their correlations: \
         not stated",
        "name not stated",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn details_and_calibration_are_printed() {
    let bench = bench();
    make(&bench, &ALL).ok();
    let text = pdf(&bench).words().join(" ");
    for words in [
        "certificate number 2026-0117",
        "lens Rodenstock, serial number RS-192",
        "valid until 2028-03-14",
        "A. Berg",
        "redundancy 20812",
        "gross errors rejected 1",
        "Points were observed up to 48.50 mm from the principal point",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let number = |key: &str| {
        content(&bench)["parameters"]["observed"][key]
            .as_f64()
            .unwrap()
    };
    assert!((number("corner_radius_mm") - 57.04).abs() < 0.006);
    let share = number("extrapolated_percent");
    assert!(share > 5.0 && share < 15.0, "{share}");
}

#[test]
fn summary_of_calibrate_five_is_read() {
    let bench = bench();
    let mut observations =
        "x_mm,y_mm,dx_um,dy_um,vh_per_s,exposure_s,opening_offset_mm\n".to_owned();
    for step in 0..60_i32 {
        let [x, y] = [step % 8 - 4, step % 7 - 3].map(|place| f64::from(9 * place));
        let r2 = x * x + y * y;
        let noise = f64::from(step % 5) * 0.02;
        let k = 1e-4 - 1e-6 * r2;
        let (dx, dy) = (1e3 * x * k + noise, 1e3 * y * k - noise);
        let (vh, time) = (
            0.05 + 0.04 * f64::from(step % 3),
            0.002 * f64::from(1 + step % 4),
        );
        writeln!(observations, "{x},{y},{dx},{dy},{vh},{time},0.02").unwrap();
    }
    fs::write(bench.path("o.csv"), observations).unwrap();
    let five = [
        "calibrate",
        "five",
        "o.csv",
        "--camera",
        "camera.toml",
        "--out",
        "five",
    ];
    bench.run(&five).ok();
    let arguments = [
        "certificate",
        "--camera",
        "five/camera.toml",
        "--calibration",
    ];
    let more = ["five/summary.json", "--out", "out"];
    bench.run(&[&arguments[..], &more].concat()).ok();
    let content = content(&bench);
    let calibration = &content["parameters"]["calibrations"][0];
    assert_eq!(calibration["method"], "five");
    let summary = fs::read_to_string(bench.path("five/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let accepted = summary["accepted"].as_u64().unwrap();
    assert!(accepted > 40);
    assert_eq!(calibration["observations"], 2 * accepted);
    assert_eq!(calibration["redundancy"], summary["redundancy"]);
    assert_eq!(calibration["rejected"], 60 - accepted);
    let values = content["parameters"]["values"].as_array().unwrap();
    let km0 = values.iter().find(|line| line["name"] == "km0").unwrap();
    assert!(km0["sigma"].as_f64().unwrap() > 0.0);
    assert_eq!(km0["calibration"], "summary.json");
    assert_eq!(content["parameters"]["correlations"][0]["rows"][0][0], 1.0);
    assert!(
        content["parameters"]["observed"]["radius_mm"]
            .as_f64()
            .unwrap()
            > 40.0
    );
}

#[test]
fn wrong_details_and_calibrations_are_refused() {
    let bench = bench();
    let camera = CAMERA.replace("name = ", "serial = \"A7\"\nname = ");
    fs::write(bench.path("camera.toml"), camera).unwrap();
    let refused = |file: &str, text: &str, option: &str, words: &[&str]| {
        fs::write(bench.path(file), text).unwrap();
        make(&bench, &[option, file]).refused(words);
        assert!(!bench.path("out").exists());
    };
    refused("d.toml", "colour = 1", "--details", &["d.toml", "colour"]);
    refused(
        "d.toml",
        "number = \"\"",
        "--details",
        &["line 1", "number", "blank"],
    );
    let serial = "[camera]\nserial = \"B8\"";
    refused(
        "d.toml",
        serial,
        "--details",
        &["camera.serial", "B8", "A7"],
    );
    refused(
        "d.toml",
        "remarks = \"\u{6f22}\"",
        "--details",
        &["no glyph", "漢"],
    );
    let long = format!("remarks = \"{}\"", "x\\n".repeat(480));
    refused("d.toml", &long, "--details", &["pages", "at most 8"]);
    refused("s.json", "{}", "--calibration", &["s.json", "no summary"]);
    let other = SUMMARY.replace("Test camera", "Other camera");
    refused(
        "s.json",
        &other,
        "--calibration",
        &["Other camera", "Test camera"],
    );
    let other = SUMMARY.replace("\"value\":-1e-6", "\"value\":-1.1e-6");
    refused(
        "s.json",
        &other,
        "--calibration",
        &["k1 = -0.0000011", "-0.000001"],
    );
    make(
        &bench,
        &[
            "--calibration",
            "summary.json",
            "--calibration",
            "summary.json",
        ],
    )
    .refused(&["principal_distance_mm", "summary.json", "too"]);
    make(&bench, &["--details", "none.toml"]).refused(&["none.toml"]);
    make(&bench, &["--sign", "details.toml"]).refused(&["no private key", "openssl genpkey"]);
    bench.run(&["certificate"]).refused(&["--camera"]);
}

#[test]
fn camera_file_must_not_be_called_as_the_certificate_is() {
    let bench = Bench::new();
    fs::write(bench.path("certificate.json"), CAMERA).unwrap();
    let arguments = [
        "certificate",
        "--camera",
        "certificate.json",
        "--out",
        "out",
    ];
    bench
        .run(&arguments)
        .refused(&["certificate.json", "rename"]);
}

#[test]
fn form_lists_all_that_is_missing_and_nothing_is_written() {
    let bench = bench();
    let form = |required: &str| {
        let text = format!("name = \"Form 12\"\nrequired = [{required}]\n");
        fs::write(bench.path("form.toml"), text).unwrap();
    };
    form(
        "\"identity.number\", \"identity.stage.serial\", \"parameters.values.k1.sigma\", \"proof\"",
    );
    let answer = make(
        &bench,
        &["--require", "form.toml", "--details", "details.toml"],
    );
    answer.failed(
        1,
        &[
            "Form 12",
            "identity.stage.serial",
            "parameters.values.k1.sigma",
        ],
    );
    assert!(
        !answer.stderr.contains("identity.number"),
        "{}",
        answer.stderr
    );
    assert!(!bench.path("out").exists());
    let details = format!("{DETAILS}[stage]\nserial = \"S1\"\n");
    fs::write(bench.path("details.toml"), details).unwrap();
    let all = [&ALL[..], &["--require", "form.toml"]].concat();
    make(&bench, &all).ok();
    form("\"identity.colour\"");
    make(&bench, &["--require", "form.toml"]).refused(&["identity.colour", "no key"]);
}
