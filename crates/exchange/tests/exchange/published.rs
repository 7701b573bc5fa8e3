//! Residuals and coefficients of the published cameras, against those of independent fits.

#![expect(
    clippy::unreadable_literal,
    reason = "numbers are compared digit by digit with those of others"
)]

use fmc_exchange::program::Program;

use crate::support::{all_terms, cameras, ixm, pinhole, published, rc30, text, written};

/// Program and model of each column of the table.
const COLUMNS: [(Program, &str); 4] = [
    (Program::Colmap, "OPENCV"),
    (Program::OpenCv, "opencv5"),
    (Program::Colmap, "FULL_OPENCV"),
    (Program::Metashape, "frame"),
];

/// Largest and RMS residual, µm, found elsewhere for the same models.
const RESIDUALS_UM: [(&str, [[f64; 2]; 4]); 4] = [
    (
        "rc30-5324.toml",
        [
            [0.0006, 0.0001],
            [0.0007, 0.0],
            [0.0005, 0.0],
            [0.0005, 0.0],
        ],
    ),
    (
        "rc30-5282.toml",
        [
            [0.0027, 0.0002],
            [0.0017, 0.0002],
            [0.0017, 0.0002],
            [0.0017, 0.0002],
        ],
    ),
    (
        "phase-one-ixu-rs1000-50.toml",
        [
            [1.344, 0.152],
            [0.285, 0.036],
            [0.183, 0.034],
            [0.180, 0.034],
        ],
    ),
    (
        "phase-one-ixm-rs150f-50.toml",
        [[6.08, 0.70], [0.402, 0.040], [0.190, 0.032], [0.208, 0.032]],
    ),
];

/// Half a unit of the last decimal that the table has, µm.
const ROUNDING_UM: f64 = 0.000_05;

fn assert_near(found: [f64; 2], expected: [f64; 2], what: &str) {
    for ((found, expected), part) in found.into_iter().zip(expected).zip([0.25, 0.2]) {
        let allowed = part * expected + ROUNDING_UM;
        assert!(
            (found - expected).abs() <= allowed,
            "{what}: {found} µm, not {expected} µm"
        );
    }
}

#[test]
fn residuals_are_those_of_independent_fits() {
    for (file, row) in RESIDUALS_UM {
        for ((program, model), expected) in COLUMNS.into_iter().zip(row) {
            let residual = written(&published(file), program, model).residual;
            let found = [residual.largest_um, residual.rms_um];
            assert_near(found, expected, &format!("{file} {model}"));
        }
    }
    let tilted = written(&ixm(), Program::OpenCv, "opencv14").residual;
    assert_near(
        [tilted.largest_um, tilted.rms_um],
        [0.025, 0.005],
        "iXM opencv14",
    );
    let row = [[24.2, 2.6], [2.23, 0.68], [1.72, 0.67], [0.169, 0.030]];
    for ((program, model), expected) in COLUMNS.into_iter().zip(row) {
        let residual = written(&all_terms(), program, model).residual;
        assert_near([residual.largest_um, residual.rms_um], expected, model);
    }
}

#[test]
fn coefficients_of_the_ixm_are_those_of_independent_fits() {
    let near = |found: f64, expected: f64, part: f64| {
        assert!(
            (found - expected).abs() <= part * expected.abs(),
            "{found}, not {expected}"
        );
    };
    let five = pinhole(&written(&ixm(), Program::OpenCv, "opencv5"));
    for (found, expected) in [
        (five.focal_px[0], 13662.553191),
        (five.focal_px[1], 13662.553191),
        (five.centre_px[0], 7117.031915),
        (five.centre_px[1], 5331.856383),
        (five.radial[0], -0.042206339),
        (five.radial[1], 0.046054035),
        (five.radial[2], -0.027791393),
        (five.decentring[0], -0.00022430574),
        (five.decentring[1], 0.00010113576),
    ] {
        near(found, expected, 1e-7);
    }
    // Printed to fewer digits by the least squares than they are determined by the points.
    let metashape = text(&written(&ixm(), Program::Metashape, ""));
    let element = |name: &str| {
        let rest = metashape.split(&format!("<{name}>")).nth(1).unwrap();
        rest.split('<').next().unwrap().parse::<f64>().unwrap()
    };
    for (name, expected) in [
        ("f", 13662.553191),
        ("cx", 15.531915),
        ("cy", 6.356383),
        ("k1", -0.042343457),
        ("k2", 0.047905614),
        ("k3", -0.035308090),
        ("k4", 0.0094140899),
        ("p1", 0.00010113927),
        ("p2", -0.00022430391),
    ] {
        near(element(name), expected, 2e-6);
    }
    let all = text(&written(&all_terms(), Program::Metashape, ""));
    for (name, expected) in [
        ("b1", 1.13194),
        ("b2", 0.684085),
        ("cx", 40.0),
        ("cy", 24.0),
    ] {
        let rest = all.split(&format!("<{name}>")).nth(1).unwrap();
        near(
            rest.split('<').next().unwrap().parse().unwrap(),
            expected,
            1e-5,
        );
    }
}

#[test]
fn corners_project_where_other_programs_put_them() {
    for (program, model, half_px, expected) in [
        (
            Program::OpenCv,
            "opencv5",
            0.0,
            [
                [0.0382, 0.0253],
                [14202.9345, 10650.9468],
                [2840.7922, 7989.0096],
            ],
        ),
        (
            Program::Colmap,
            "FULL_OPENCV",
            0.5,
            [
                [-0.0191, -0.0177],
                [14202.9862, 10650.9856],
                [2840.7917, 7989.0099],
            ],
        ),
        (
            Program::Metashape,
            "frame",
            0.5,
            [
                [-0.0245, -0.0218],
                [14202.9908, 10650.9890],
                [2840.7924, 7989.0095],
            ],
        ),
    ] {
        let exported = written(&ixm(), program, model);
        let formula = pinhole(&exported);
        let rays = [
            [-0.527199015388, -0.394829425625],
            [0.524853654467, 0.394116559998],
            [-0.314623171376, 0.195521597090],
        ];
        for (ray, expected) in rays.into_iter().zip(expected) {
            let found = formula.pixel_from_ray(ray);
            for (found, expected) in found.into_iter().zip(expected) {
                // The quotient is degenerate: another minimum differs by thousandths of a pixel.
                assert!(
                    (found - expected).abs() < 1e-3,
                    "{model} {half_px}: {found} {expected}"
                );
            }
        }
    }
    let camera = ixm();
    let [x, y] = camera.ray_from_measured(camera.sensor_from_pixel([0.0, 0.0]));
    assert!((x + 0.527199015388).abs() < 1e-12 && (y + 0.394829425625).abs() < 1e-12);
    let camera = rc30();
    let [x, y] = camera.ray_from_measured(camera.sensor_from_pixel([3600.0, 13500.0]));
    assert!((x + 0.447514968344).abs() < 1e-12 && (y - 0.372967728760).abs() < 1e-12);
}

#[test]
fn smallest_model_below_a_hundredth_of_a_pixel_is_taken() {
    assert_eq!(written(&rc30(), Program::OpenCv, "").model, "opencv5");
    assert_eq!(written(&rc30(), Program::Colmap, "").model, "OPENCV");
    assert_eq!(written(&ixm(), Program::OpenCv, "").model, "opencv14");
    assert_eq!(written(&ixm(), Program::Colmap, "").model, "FULL_OPENCV");
    assert_eq!(
        written(&ixm(), Program::Ros, "").model,
        "rational_polynomial"
    );
}

#[test]
fn terms_without_a_place_are_named_with_their_size() {
    let camera = all_terms();
    // B2 ȳ at the lower edge, from (x0, y0): 6e-5 x (26.88 - 0.21) mm, by 1 - K0.
    let b2_um = 6e-5 * (26.88 - 0.21 + 2.0 * 0.21) * 1e3 / (1.0 - 2e-4);
    let colmap = written(&camera, Program::Colmap, "FULL_OPENCV");
    assert_eq!(colmap.not_held.len(), 1);
    assert_eq!(colmap.not_held[0].term, "B2");
    assert!((colmap.not_held[0].size_um - b2_um).abs() < 1e-9);
    let terms = |program, model| {
        let exported = written(&camera, program, model);
        exported
            .not_held
            .iter()
            .map(|one| one.term)
            .collect::<Vec<_>>()
    };
    assert_eq!(terms(Program::Pix4d, ""), ["B1", "B2"]);
    assert_eq!(terms(Program::OpenTrackIo, ""), ["B1", "B2"]);
    assert_eq!(terms(Program::Metashape, ""), [""; 0]);
    assert_eq!(terms(Program::MicMac, ""), [""; 0]);
    assert_eq!(terms(Program::Colmap, "RADIAL"), ["P1, P2", "B1", "B2"]);
    assert!(cameras().len() == 6);
}
