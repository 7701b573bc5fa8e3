//! Formulas of the programs that correct measured points, written here as their documents have
//! them, with the numbers of the files.

#![expect(
    clippy::many_single_char_names,
    clippy::unreadable_literal,
    reason = "formulas and numbers are those of the documents"
)]

use fmc_exchange::program::Program;

use crate::support::{all_terms, cameras, ixm, rc30, text, written};

/// Largest difference of the formula from the strict camera, mm: rounding.
const ROUNDING_MM: f64 = 1e-12;

/// Returns the number of an XML element.
fn element(text: &str, name: &str) -> Vec<f64> {
    text.split(&format!("<{name}>"))
        .skip(1)
        .flat_map(|rest| rest.split('<').next().unwrap().split_whitespace())
        .map(|word| word.parse().unwrap())
        .collect()
}

/// Returns the number of a line of a report.
fn line(text: &str, name: &str) -> f64 {
    let line = text.lines().find_map(|line| line.trim().strip_prefix(name));
    line.unwrap().trim().parse().unwrap()
}

#[test]
fn opentrackio_is_the_formula_of_openlensio() {
    for camera in [ixm(), rc30()] {
        let exported = written(&camera, Program::OpenTrackIo, "");
        let sample: serde_json::Value = serde_json::from_str(&text(&exported)).unwrap();
        let lens = &sample["lens"];
        let list = |name: &str| -> Vec<f64> {
            let list = lens["distortion"][0][name].as_array().unwrap();
            list.iter().map(|one| one.as_f64().unwrap()).collect()
        };
        let (k, p) = (list("radial"), list("tangential"));
        let focal = lens["pinholeFocalLength"].as_f64().unwrap();
        let [offset_x, offset_y] =
            ["x", "y"].map(|axis| lens["projectionOffset"][axis].as_f64().unwrap());
        assert_eq!(lens["distortionOffset"]["x"], 0.0);
        let mut worst = 0.0_f64;
        for point in camera.grid_mm(21) {
            // y down; numerator k1 k3 k5, denominator k2 k4 k6.
            let (x, y) = (point[0] - offset_x, -point[1] - offset_y);
            let r2 = x * x + y * y;
            let quotient = (1.0 + k[0] * r2 + k[2] * r2.powi(2) + k[4] * r2.powi(3))
                / (1.0 + k[1] * r2 + k[3] * r2.powi(2) + k[5] * r2.powi(3));
            let u = x * quotient + 2.0 * p[0] * x * y + p[1] * (r2 + 2.0 * x * x);
            let v = y * quotient + 2.0 * p[1] * x * y + p[0] * (r2 + 2.0 * y * y);
            let [strict_x, strict_y] = camera.ray_from_measured(point);
            worst = worst.max(
                (u - strict_x * focal)
                    .abs()
                    .max((v - strict_y * focal).abs()),
            );
        }
        assert!(worst < ROUNDING_MM, "{worst} mm");
    }
    let sample = text(&written(&ixm(), Program::OpenTrackIo, ""));
    let sample: serde_json::Value = serde_json::from_str(&sample).unwrap();
    let distortion = &sample["lens"]["distortion"][0];
    let radial = serde_json::json!([1.6056e-5, 0.0, -6.18966e-9, 0.0, 1.31329e-12, 0.0]);
    assert_eq!(distortion["radial"], radial);
    assert_eq!(
        distortion["tangential"],
        serde_json::json!([4.51202e-6, -2.0419e-6])
    );
    assert_eq!(
        sample["lens"]["projectionOffset"],
        serde_json::json!({"x": 0.0584, "y": 0.0239})
    );
}

#[test]
fn micmac_is_the_formula_of_its_source_with_all_terms() {
    for camera in cameras() {
        let file = text(&written(&camera, Program::MicMac, ""));
        let (focal, c) = (element(&file, "F")[0], element(&file, "CoeffDist"));
        let (centre, pp) = (element(&file, "CDist"), element(&file, "PP"));
        let [p1, p2, b1, b2] = ["P1", "P2", "b1", "b2"].map(|name| element(&file, name)[0]);
        let mut worst = 0.0_f64;
        for point in camera.grid_mm(21) {
            let [col, row] = camera.pixel_from_sensor(point);
            let (u, v) = (col - centre[0], row - centre[1]);
            let r2 = u * u + v * v;
            let factor = 1.0 + c[0] * r2 + c[1] * r2.powi(2) + c[2] * r2.powi(3);
            let x = u * factor + p1 * (r2 + 2.0 * u * u) + 2.0 * p2 * u * v + b1 * u + b2 * v;
            let y = v * factor + p2 * (r2 + 2.0 * v * v) + 2.0 * p1 * u * v;
            let [strict_x, strict_y] = camera.ray_from_measured(point);
            let off = [x - strict_x * focal, y - strict_y * focal];
            worst = worst.max(off[0].abs().max(off[1].abs()) * camera.pixel_mm);
        }
        assert_eq!(centre, pp);
        assert!(worst < 10.0 * ROUNDING_MM, "{}: {worst} mm", camera.name);
    }
    let exported = written(&ixm(), Program::MicMac, "");
    assert_eq!(
        exported.files[0].0,
        "AutoCal_Foc-51371_Cam-Phase_One_iXM_RS150F_50_mm.xml"
    );
    let file = text(&exported);
    for (name, expected) in [
        (
            "CoeffDist",
            vec![2.269933056e-10, -1.23713808e-18, 3.71097225e-27],
        ),
        ("P1", vec![-7.677544e-9]),
        ("P2", vec![1.696519520e-8]),
    ] {
        for (found, expected) in element(&file, name).into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-8, "{name}: {found}");
        }
    }
}

#[test]
fn australis_and_photomodeler_are_browns_corrections() {
    for (program, point_names) in [
        (Program::Australis, ["C ", "XP ", "YP "]),
        (Program::PhotoModeler, ["Focal Length ", "XP ", "YP "]),
    ] {
        for camera in cameras() {
            if camera.name == "all terms" {
                continue;
            }
            let file = text(&written(&camera, program, ""));
            let [focal, xp, yp] = point_names.map(|name| line(&file, name));
            let [k1, k2, k3, p1, p2] =
                ["K1 ", "K2 ", "K3 ", "P1 ", "P2 "].map(|name| line(&file, name));
            let mut worst = 0.0_f64;
            for point in camera.grid_mm(21) {
                let (x, y) = (point[0] - xp, point[1] - yp);
                let r2 = x * x + y * y;
                let radial = k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
                let ideal_x = x + x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y;
                let ideal_y = y + y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y;
                let [strict_x, strict_y] = camera.ray_from_measured(point);
                let off = [ideal_x - strict_x * focal, ideal_y + strict_y * focal];
                worst = worst.max(off[0].abs().max(off[1].abs()));
            }
            assert!(worst < ROUNDING_MM, "{}: {worst} mm", camera.name);
        }
    }
    let file = text(&written(&ixm(), Program::Australis, ""));
    let names = ["C ", "XP ", "YP ", "K1 ", "K2 ", "K3 ", "P1 ", "P2 "];
    let expected = [
        51.3712,
        0.0584,
        -0.0239,
        1.6056e-5,
        -6.18966e-9,
        1.31329e-12,
        -2.0419e-6,
        -4.51202e-6,
    ];
    for (name, expected) in names.into_iter().zip(expected) {
        assert_eq!(
            line(&file, name).to_bits(),
            f64::to_bits(expected),
            "{name}"
        );
    }
    // From the corner of the format, as the dialogue shows it.
    let file = text(&written(&ixm(), Program::PhotoModeler, ""));
    assert!((line(&file, "Principal Point X ") - 26.76192).abs() < 1e-12);
    assert!((line(&file, "Principal Point Y ") - 20.04966).abs() < 1e-12);
}

#[test]
fn point_of_the_ixm_is_corrected_as_elsewhere() {
    let camera = ixm();
    let [x0, y0] = camera.principal_point_mm;
    let [x, y] = camera.ideal_from_measured([30.0 + x0, 20.0 + y0]);
    assert!((x - 30.387182867900).abs() < 1e-11 && (y - 20.254025932600).abs() < 1e-11);
}

#[test]
fn affinity_whose_sign_is_not_known_is_not_written() {
    let choices = fmc_exchange::export::Choices::default();
    let error = fmc_exchange::export::export(&all_terms(), Program::Australis, &choices);
    assert!(error.unwrap_err().to_string().contains("B1 or B2"));
}
