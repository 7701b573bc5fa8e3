//! Formulas of the programs that distort rays, written here as their documents have them, with the
//! numbers of the files: a mistake that writer and reader share is seen.

#![expect(
    clippy::many_single_char_names,
    reason = "the symbols are those of the documents"
)]

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::program::Program;

use crate::support::{all_terms, ixm, rc30, text, written};

/// Distorts a ray: radial numerator and denominator, p1 with y², p2 with x².
fn distorted([x, y]: [f64; 2], k: &[f64], d: &[f64], [p1, p2]: [f64; 2]) -> [f64; 2] {
    let r2 = x * x + y * y;
    let sum = |terms: &[f64]| {
        let powers = (1..).zip(terms).map(|(power, term)| term * r2.powi(power));
        1.0 + powers.sum::<f64>()
    };
    let g = sum(k) / sum(d);
    [
        x * g + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * g + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    ]
}

/// Checks that the formula, from a ray to a pixel with the first pixel centre at (0, 0), leaves the
/// residual that the export states.
fn assert_leaves(camera: &Calibrated, stated_um: f64, pixel: impl Fn([f64; 2]) -> [f64; 2]) {
    let mut largest_um = 0.0_f64;
    for point in camera.grid_mm(41) {
        let [col, row] = pixel(camera.ray_from_measured(point));
        let [strict_col, strict_row] = camera.pixel_from_sensor(point);
        let off = (col - strict_col).abs().max((row - strict_row).abs());
        largest_um = largest_um.max(off * 1e3 * camera.pixel_mm);
    }
    let name = &camera.name;
    assert!(
        (largest_um - stated_um).abs() < 1e-5 + 1e-6 * stated_um,
        "{name}: {largest_um} µm, not {stated_um} µm"
    );
}

/// Returns the numbers of the list behind the `count`th `data` or key.
fn list(text: &str, key: &str, count: usize) -> Vec<f64> {
    let rest = text.split(key).nth(count + 1).unwrap();
    let list = rest.split('[').nth(1).unwrap().split(']').next().unwrap();
    list.split(',')
        .map(|word| word.trim().parse().unwrap())
        .collect()
}

fn cameras() -> [Calibrated; 3] {
    [ixm(), rc30(), all_terms()]
}

#[test]
fn opencv_and_ros_are_opencvs_formula() {
    for (program, model) in [
        (Program::OpenCv, "opencv5"),
        (Program::OpenCv, "opencv8"),
        (Program::Ros, "plumb_bob"),
        (Program::Ros, "rational_polynomial"),
    ] {
        for camera in cameras() {
            let exported = written(&camera, program, model);
            let file = text(&exported);
            let (m, c) = (list(&file, "data", 0), list(&file, "data", 1));
            let divisor = if c.len() == 8 { &c[5..] } else { &[][..] };
            assert_leaves(&camera, exported.residual.largest_um, |ray| {
                let [x, y] = distorted(ray, &[c[0], c[1], c[4]], divisor, [c[2], c[3]]);
                [m[0] * x + m[2], m[4] * y + m[5]]
            });
            assert!(file.contains(&format!("image_width: {}\n", camera.size_px[0])));
            assert!(file.contains(&format!("image_height: {}\n", camera.size_px[1])));
        }
    }
}

#[test]
fn kalibr_is_radtan_with_the_first_pixel_centre_at_zero() {
    for camera in cameras() {
        let exported = written(&camera, Program::Kalibr, "");
        let file = text(&exported);
        let (i, c) = (
            list(&file, "intrinsics", 0),
            list(&file, "distortion_coeffs", 0),
        );
        assert_leaves(&camera, exported.residual.largest_um, |ray| {
            let [x, y] = distorted(ray, &c[..2], &[], [c[2], c[3]]);
            [i[0] * x + i[2], i[1] * y + i[3]]
        });
        let size = list(&file, "resolution", 0);
        assert_eq!(size, camera.size_px.map(f64::from).to_vec());
    }
}

#[test]
fn colmap_counts_pixels_from_the_corner() {
    for camera in cameras() {
        for (model, k_count) in [("RADIAL", 2), ("OPENCV", 2), ("FULL_OPENCV", 3)] {
            let exported = written(&camera, Program::Colmap, model);
            let file = text(&exported);
            let line = file.lines().find(|line| !line.starts_with('#')).unwrap();
            let words: Vec<_> = line.split(' ').collect();
            assert_eq!(words[..2], ["1", model]);
            assert_eq!(words[2..4], camera.size_px.map(|side| side.to_string()));
            let n: Vec<f64> = words[4..]
                .iter()
                .map(|word| word.parse().unwrap())
                .collect();
            assert_leaves(&camera, exported.residual.largest_um, |ray| {
                let (k, d, p, [fx, fy, cx, cy]) = match model {
                    "RADIAL" => (n[3..5].to_vec(), vec![], [0.0; 2], [n[0], n[0], n[1], n[2]]),
                    "OPENCV" => (
                        n[4..6].to_vec(),
                        vec![],
                        [n[6], n[7]],
                        [n[0], n[1], n[2], n[3]],
                    ),
                    _ => (
                        vec![n[4], n[5], n[8]],
                        n[9..12].to_vec(),
                        [n[6], n[7]],
                        [n[0], n[1], n[2], n[3]],
                    ),
                };
                assert_eq!(k.len(), k_count);
                let [x, y] = distorted(ray, &k, &d, p);
                [fx * x + cx - 0.5, fy * y + cy - 0.5]
            });
        }
    }
}

#[test]
fn metashape_counts_from_the_middle_and_its_p1_goes_with_x() {
    for camera in cameras() {
        let exported = written(&camera, Program::Metashape, "");
        let file = text(&exported);
        let e = |name: &str| -> f64 {
            let rest = file.split(&format!("<{name}>")).nth(1).unwrap();
            rest.split('<').next().unwrap().parse().unwrap()
        };
        let [width, height] = [e("width"), e("height")];
        let k = ["k1", "k2", "k3", "k4"].map(e);
        assert_leaves(&camera, exported.residual.largest_um, |ray| {
            // The manual's P1 (r² + 2x²) + 2 P2 xy.
            let [x, y] = distorted(ray, &k, &[], [e("p2"), e("p1")]);
            let u = width * 0.5 + e("cx") + x * e("f") + x * e("b1") + y * e("b2");
            let v = height * 0.5 + e("cy") + y * e("f");
            [u - 0.5, v - 0.5]
        });
    }
}

#[test]
fn opensfm_divides_by_the_longer_side_and_counts_from_the_middle() {
    for camera in cameras() {
        let exported = written(&camera, Program::OpenSfm, "");
        assert_eq!(exported.files[0].1, exported.files[1].1);
        let tree: serde_json::Value = serde_json::from_str(&text(&exported)).unwrap();
        let (_, c) = tree.as_object().unwrap().iter().next().unwrap();
        let n = |name: &str| c[name].as_f64().unwrap();
        let size = n("width").max(n("height"));
        assert_leaves(&camera, exported.residual.largest_um, |ray| {
            let k = [n("k1"), n("k2"), n("k3")];
            let [x, y] = distorted(ray, &k, &[], [n("p1"), n("p2")]);
            [
                (n("focal_x") * x + n("c_x")) * size + n("width") / 2.0 - 0.5,
                (n("focal_y") * y + n("c_y")) * size + n("height") / 2.0 - 0.5,
            ]
        });
    }
}

#[test]
fn opf_and_pix4d_count_from_the_corner_with_one_principal_distance() {
    for camera in cameras() {
        let exported = written(&camera, Program::Opf, "");
        let tree: serde_json::Value = serde_json::from_str(&text(&exported)).unwrap();
        let internals = &tree["sensors"][0]["internals"];
        let n = |name: &str, index: usize| internals[name][index].as_f64().unwrap();
        let focal = internals["focal_length_px"].as_f64().unwrap();
        assert_leaves(&camera, exported.residual.largest_um, |ray| {
            let k = [0, 1, 2].map(|index| n("radial_distortion", index));
            let p = [0, 1].map(|index| n("tangential_distortion", index));
            let [x, y] = distorted(ray, &k, &[], p);
            let [cx, cy] = [0, 1].map(|index| n("principal_point_px", index));
            [focal * x + cx - 0.5, focal * y + cy - 0.5]
        });
        let exported = written(&camera, Program::Pix4d, "");
        let cam = text(&exported);
        let n = |name: &str| -> f64 {
            let line = cam.lines().find_map(|line| line.strip_prefix(name));
            line.unwrap().trim().parse().unwrap()
        };
        let in_cam = ["K1 ", "K2 ", "K3 ", "T1 ", "T2 "].map(n);
        let xmp = String::from_utf8(exported.files[1].1.clone()).unwrap();
        let in_xmp: Vec<f64> = xmp
            .split("<rdf:li>")
            .skip(1)
            .map(|rest| rest.split('<').next().unwrap().parse().unwrap())
            .collect();
        assert_eq!(in_xmp, in_cam);
        let point = xmp.split("<Camera:PrincipalPoint>").nth(1).unwrap();
        let point = point.split('<').next().unwrap().split_once(',').unwrap();
        assert_eq!(point.0.parse(), Ok(n("Px ")));
        assert_eq!(point.1.parse(), Ok(n("Py ")));
        assert_leaves(&camera, exported.residual.largest_um, |ray| {
            let [x, y] = distorted(ray, &in_cam[..3], &[], [in_cam[3], in_cam[4]]);
            // mm from the upper left corner.
            let px = |mm: f64| mm / camera.pixel_mm - 0.5;
            [px(n("F ") * x + n("Px ")), px(n("F ") * y + n("Py "))]
        });
    }
}

#[test]
fn numbers_of_the_ixm_are_those_of_the_documents() {
    let cam = text(&written(&ixm(), Program::Pix4d, ""));
    assert!(
        cam.contains("\nPx 26.76192\nPy 20.04966") || cam.contains("\nPx 26.76192\nPy 20.04965")
    );
    let opensfm = text(&written(&ixm(), Program::OpenSfm, ""));
    for number in ["0.961880680", "0.00109348879", "0.00044750654"] {
        assert!(opensfm.contains(number), "{number}: {opensfm}");
    }
}
