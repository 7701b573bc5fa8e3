//! Numbers of the pages, of `certificate.json` and of the library.

use std::collections::BTreeSet;
use std::fs;

use fmc_camera::flight::exposure::Exposure;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{self, Choices};
use fmc_exchange::program::Program;
use fmc_reference::lens::Lens;
use serde_json::Value;

use super::super::support::{Bench, CAMERA};
use super::bench::{ALL, bench, content, make, pdf};

/// Largest files of a certificate, bytes.
const LARGEST: u64 = 1_000_000;

/// Most pages of a certificate.
const PAGES: usize = 8;

fn decimal(number: f64) -> String {
    // Adding zero turns -0 into 0.
    format!("{:e}", number + 0.0)
}

/// Returns the numbers of a text, in one form.
fn numbers(text: &str) -> BTreeSet<String> {
    text.split_whitespace()
        .map(|word| word.trim_matches(|c: char| ",;:()°|".contains(c)))
        .map(|word| word.strip_suffix('.').unwrap_or(word))
        .filter_map(|word| word.strip_prefix('±').unwrap_or(word).parse::<f64>().ok())
        .filter(|number| number.is_finite())
        .map(decimal)
        .collect()
}

/// Adds the numbers of a value, and those in its texts.
fn add(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::Number(number) => {
            found.insert(decimal(number.as_f64().unwrap()));
        }
        Value::String(text) => found.extend(numbers(text)),
        Value::Array(list) => list.iter().for_each(|value| add(value, found)),
        Value::Object(object) => object.values().for_each(|value| add(value, found)),
        _ => {}
    }
}

fn of_json(value: &Value) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    add(value, &mut found);
    found
}

/// Returns the numbers at the axes and arrows of the figures, which the HTML page has as text.
fn of_figures(html: &str) -> BTreeSet<String> {
    html.split("<svg")
        .skip(1)
        .filter_map(|figure| figure.split("</svg>").next())
        .flat_map(|figure| figure.split("<text").skip(1))
        .filter_map(|text| text.split('>').nth(1)?.split('<').next())
        .flat_map(numbers)
        .collect()
}

#[test]
fn pdf_has_the_numbers_of_the_json_file_and_no_others() {
    let bench = bench();
    make(&bench, &ALL).ok();
    let pdf = pdf(&bench);
    let content = content(&bench);
    let html = fs::read_to_string(bench.path("out/certificate.html")).unwrap();
    let printed = numbers(&pdf.pages.join("\n"));
    assert!(printed.len() > 200, "{}", printed.len());

    let mut known = of_json(&content);
    known.extend(of_figures(&html));
    // Of the sentences: 1 - K0, one-to-one above 0; of the foot: the numbers of the pages.
    known
        .extend((0..=pdf.pages.len()).map(|page| decimal(f64::from(u32::try_from(page).unwrap()))));
    let unknown: Vec<_> = printed.difference(&known).collect();
    assert!(unknown.is_empty(), "{unknown:?}");

    // The profile is drawn, and not printed.
    let mut stated = content;
    stated["static_distortion"]["profile"] = Value::Null;
    let stated = of_json(&stated);
    let left_out: Vec<_> = stated.difference(&printed).collect();
    assert!(left_out.is_empty(), "{left_out:?}");
    let in_html = numbers(&html.replace(['<', '>'], " "));
    let left_out: Vec<_> = printed.difference(&in_html).collect();
    // The page has no foot with numbers of pages.
    assert!(left_out.len() <= pdf.pages.len(), "{left_out:?}");
}

#[test]
fn parameters_and_profiles_are_those_of_the_camera_file() {
    let bench = bench();
    make(&bench, &ALL).ok();
    let content = content(&bench);
    let (camera, _) = CameraFile::parse("camera.toml", CAMERA).unwrap();
    let lens = Lens::of(&camera);
    let values = content["parameters"]["values"].as_array().unwrap();
    let value = |name: &str| {
        let line = values.iter().find(|line| line["name"] == name).unwrap();
        (line["value"].as_f64().unwrap(), line["sigma"].as_f64())
    };
    assert_eq!(value("principal_distance_mm"), (100.0, Some(0.00074)));
    assert_eq!(value("k1"), (-1e-6, Some(2.3e-10)));
    assert_eq!(value("k3"), (0.0, None));
    assert_eq!(value("b2"), (2e-5, None));
    assert_eq!(value("kd1"), (1e-6, None));

    let distortion = &content["static_distortion"];
    for table in ["at_angles", "at_radii", "profile"] {
        let rows = distortion[table].as_array().unwrap();
        assert!(rows.len() >= 5, "{table}");
        for row in rows {
            let number = |key: &str| row[key].as_f64().unwrap();
            let r = number("radius_mm");
            let radial = Lens {
                p: [0.0; 2],
                b: [0.0; 2],
                ..lens
            };
            let [dx, _] = radial.displacement([r, 0.0]);
            // The radius is stated to 0.1 µm, the distortion to 1 nm.
            assert!(
                (1e3 * dx - number("gaussian_um")).abs() < 6e-4,
                "{table} {r}"
            );
            let angle = ((r - dx) / 100.0).atan().to_degrees();
            assert!((angle - number("angle_deg")).abs() < 6e-4, "{table} {r}");
            let decentring = 1e3 * r * r * 1e-6_f64.hypot(2e-6);
            assert!(
                (decentring - number("decentring_um")).abs() < 6e-4,
                "{table} {r}"
            );
            let [a, b] = [2.3e-10 * r.powi(3), 7.1e-14 * r.powi(5)];
            let sigma = 1e3 * (a * a + b * b - 2.0 * 0.96 * a * b).sqrt();
            assert!((sigma - number("sigma_um")).abs() < 6e-4, "{table} {r}");
        }
    }
    let largest = |key: &str| {
        let rows = distortion["profile"].as_array().unwrap().iter();
        let numbers = rows.map(|row| row[key].as_f64().unwrap().abs());
        numbers.fold(0.0, f64::max)
    };
    for (key, largest) in [
        ("gaussian_largest_um", largest("gaussian_um")),
        ("balanced_largest_um", largest("balanced_um")),
    ] {
        assert!(
            (distortion[key].as_f64().unwrap() - largest).abs() < 1e-9,
            "{key}"
        );
    }
    assert_eq!(content["parameters"]["observed"]["radius_mm"], 48.5);
}

#[test]
fn motion_is_that_of_the_library() {
    let bench = bench();
    make(&bench, &[]).ok();
    let content = content(&bench);
    let (_, camera) = CameraFile::parse("camera.toml", CAMERA).unwrap();
    let rows = content["motion"]["exposures"].as_array().unwrap();
    assert_eq!(rows.len(), 20);
    for row in rows {
        let vh = row["vh_per_s"].as_f64().unwrap();
        let time = row["exposure_ms"].as_f64().unwrap() / 1e3;
        let frame = camera.frame(&Exposure::new(single(vh), single(time)));
        let interior = frame.unwrap().interior;
        let motion = interior.motion;
        for (key, value, allowed) in [
            ("travel_um", 1e3 * motion.travel_mm, 6e-4),
            ("opening_offset_um", 1e3 * motion.opening_offset_mm, 6e-4),
            ("centroid_offset_um", 1e3 * motion.centroid_mm, 6e-4),
            ("centroid_time_ms", 1e3 * motion.centroid_time_s, 6e-5),
            ("left_out_nm", interior.left_out_nm, 6e-4),
        ] {
            let stated = row["frame"][key].as_f64().unwrap();
            assert!(
                (stated - f64::from(value)).abs() < allowed,
                "{key}: {stated} {value}"
            );
        }
        let point = &row["frame"]["principal_point_mm"];
        let y = f64::from(interior.principal_point.y_mm);
        assert!((point[1].as_f64().unwrap() - y).abs() < 6e-7);
    }
    let reach = content["motion"]["reach"].as_array().unwrap();
    assert!(reach.iter().all(|row| row["bound"] == "limits"));
}

#[test]
fn proof_is_that_of_verify_and_exchange_that_of_export() {
    let bench = bench();
    make(&bench, &[]).ok();
    let content = content(&bench);
    let verify = [
        "verify",
        "--device",
        "sil",
        "--camera",
        "camera.toml",
        "--out",
        "v",
    ];
    bench.run(&verify).ok();
    let summary = fs::read_to_string(bench.path("v/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let camera = &summary["cameras"][0];
    let proof = &content["proof"];
    assert_eq!(proof["passed"], true);
    assert_eq!(proof["points"], camera["points"]);
    let worst = camera["worst"]["error_nm"].as_f64().unwrap();
    assert!((proof["error_max_nm"].as_f64().unwrap() - worst).abs() < 6e-4);

    let (camera, _) = CameraFile::parse("camera.toml", CAMERA).unwrap();
    let calibrated = Calibrated::of(&camera);
    let lines = content["exchange"].as_array().unwrap();
    assert_eq!(lines.len(), 12);
    for (format, program) in [
        ("opencv", Program::OpenCv),
        ("metashape", Program::Metashape),
        ("opentrackio", Program::OpenTrackIo),
    ] {
        let line = lines.iter().find(|line| line["format"] == format).unwrap();
        let exported = export::export(&calibrated, program, &Choices::default()).unwrap();
        assert_eq!(line["model"], exported.model);
        let stated = line["residual_max_um"].as_f64().unwrap();
        assert!(
            (stated - exported.residual.largest_um).abs() < 6e-5,
            "{format}"
        );
    }
    // Australis has no place for B1 and B2 and refuses.
    let australis = lines
        .iter()
        .find(|line| line["format"] == "australis")
        .unwrap();
    assert!(australis["refused"].as_str().is_some() && australis["model"].is_null());
}

#[test]
fn same_input_has_the_same_bytes_and_little_of_them() {
    let (one, other) = (bench(), bench());
    make(&one, &ALL).ok();
    make(&other, &ALL).ok();
    let names = |bench: &Bench| {
        let entries = fs::read_dir(bench.path("out")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect::<BTreeSet<_>>()
    };
    assert_eq!(names(&one), names(&other));
    assert_eq!(names(&one).len(), 7);
    let mut size = 0;
    for name in names(&one) {
        let bytes = |bench: &Bench| fs::read(bench.path(&format!("out/{name}"))).unwrap();
        assert_eq!(bytes(&one), bytes(&other), "{name}");
        size += bytes(&one).len() as u64;
    }
    assert!(size < LARGEST, "{size}");
    assert!(pdf(&one).pages.len() <= PAGES);
}

#[test]
fn every_kind_of_camera_has_a_certificate() {
    let stage = "stroke_mm = 0.4\nmax_speed_mm_s = 9.0";
    for (change, to, words) in [
        (
            "mechanism = \"stage\"\nstrategy = \"centred\"",
            "mechanism = \"tdi\"",
            "row periods",
        ),
        ("stroke_mm = 4.0", stage, "left out"),
        ("stroke_mm = 4.0", "stroke_mm = 0.01", "not checked"),
        ("axis = \"+y\"", "axis = \"-x\"", "-x"),
        ("width_px = 9216", "width_px = 400", "400 x 9216"),
    ] {
        let camera = CAMERA.replace(change, to);
        let bench = Bench::with(&camera, b"");
        make(&bench, &[]).ok();
        let pdf = pdf(&bench);
        assert!(pdf.pages.len() <= PAGES, "{to}");
        let text = pdf.words().join(" ");
        assert!(text.contains(words), "{to}: {text}");
        bench.run(&["certificate", "check", "out"]).ok();
    }
}
