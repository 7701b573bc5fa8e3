//! Precise angles of an area camera with its stage, by simulation.

use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::calibration::failure::CalibrationFailure;
use fmc_adjustment::calibration::field_angles::{
    FieldAngles, FieldAnglesRequest, FieldDirection, field_angles,
};
use fmc_adjustment::calibration::result::InputFile;
use fmc_camera_file::CameraFile;
use nalgebra::{Rotation3, Vector3};

use crate::noise::{Noise, binomial_half_width};

const IXM: &str = include_str!("../../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml");

/// A tenth of a pixel.
const SIGMA_MM: f64 = 0.376e-3;
/// 0.5".
const SIGMA_ANGLE: f64 = 0.5 / 3600.0 * std::f64::consts::PI / 180.0;

/// f, x0, y0, K1 to K3, P1, P2.
const ESTIMATED: [InteriorElement; 8] = [
    InteriorElement::PrincipalDistance,
    InteriorElement::X0,
    InteriorElement::Y0,
    InteriorElement::K1,
    InteriorElement::K2,
    InteriorElement::K3,
    InteriorElement::P1,
    InteriorElement::P2,
];

/// Five offsets of the stage, mm.
const OFFSETS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// s, α, z1, z2.
const STAGE: [f64; 4] = [2e-4, -3e-4, 8e-4, -1.2e-3];

/// Rotation of the mount, rad.
const MOUNT: [f64; 3] = [0.012, -0.021, 0.017];

/// The camera before the calibration: 0.1 mm and 20 µm off, without distortion.
fn camera() -> CameraFile {
    let text = format!("{IXM}\n[fmc]\naxis = \"-y\"\nstroke_mm = 2.0\nflatness_um = [1.5]\n");
    let (mut camera, _) = CameraFile::parse("camera.toml", &text).unwrap();
    camera.exit_pupil_mm = Some(76.7);
    camera
}

fn nominal() -> CameraFile {
    let mut camera = camera();
    camera.principal_distance_mm += 0.1;
    camera.principal_point_mm = [0.04, 0.0];
    camera.distortion.k1 *= 0.9;
    camera
}

/// Measured point of a direction: `docs/calibration.md` backwards.
fn measured(camera: &CameraFile, one: &FieldDirection, stage: [f64; 4]) -> [f64; 2] {
    let [s, alpha, z1, z2] = stage;
    let c = one.stage_offset_mm;
    let u = Rotation3::from_scaled_axis(Vector3::from(MOUNT)) * one.direction();
    let f = camera.principal_distance_mm;
    let ideal = [-f * u.x / u.z, -f * u.y / u.z];
    let d = camera.distortion.measured_minus_ideal();
    let [mut x, mut y] = ideal;
    for _ in 0..200 {
        let r2 = x * x + y * y;
        let radial = r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
        let dx = x * radial + d.p1 * (r2 + 2.0 * x * x) + 2.0 * d.p2 * x * y;
        let dy = y * radial + d.p2 * (r2 + 2.0 * y * y) + 2.0 * d.p1 * x * y;
        [x, y] = [ideal[0] + dx, ideal[1] + dy];
    }
    let flatness = camera.fmc.flatness_um.first().copied().unwrap_or(0.0) / 1e3;
    let larger = 1.0 + (flatness + z1 * c + z2 * c * c) / camera.exit_pupil_mm();
    let [x0, y0] = camera.principal_point_mm;
    // e = (0, -1), turned by α.
    let e = [alpha.sin(), -alpha.cos()];
    [
        x0 + (1.0 + s) * c * e[0] + larger * x,
        y0 + (1.0 + s) * c * e[1] + larger * y,
    ]
}

/// Directions of a square of `side` over the format, at these offsets of the stage.
fn directions(side: u32, offsets: &[f64], noise: Option<u64>) -> Vec<FieldDirection> {
    let camera = camera();
    let mut noise = noise.map(Noise::new);
    let mut gaussian = || noise.as_mut().map_or(0.0, Noise::gaussian);
    let [half_x, half_y] = camera.half_format_mm();
    let [reach_x, reach_y] = [half_x, half_y].map(|half| 0.94 * half - 1.0);
    let mut all = Vec::new();
    for offset in offsets {
        for index in 0..side * side {
            let [column, row] = [index % side, index / side]
                .map(|place| 2.0 * f64::from(place) / f64::from(side - 1) - 1.0);
            let azimuth = (column * reach_x / camera.principal_distance_mm).atan();
            let elevation = (row * reach_y / camera.principal_distance_mm * azimuth.cos()).atan();
            let mut one = FieldDirection {
                line: all.len() as u64 + 2,
                azimuth_deg: azimuth.to_degrees(),
                elevation_deg: elevation.to_degrees(),
                measured_mm: [0.0; 2],
                sigma_mm: SIGMA_MM,
                stage_offset_mm: *offset,
            };
            one.measured_mm = measured(&camera, &one, STAGE).map(|mm| mm + SIGMA_MM * gaussian());
            one.azimuth_deg += (SIGMA_ANGLE * gaussian()).to_degrees();
            one.elevation_deg += (SIGMA_ANGLE * gaussian()).to_degrees();
            all.push(one);
        }
    }
    all
}

fn calibrated_by(
    camera: &CameraFile,
    observations: &[FieldDirection],
    has_stage: bool,
) -> Result<FieldAngles, CalibrationFailure> {
    field_angles(&FieldAnglesRequest {
        input: InputFile {
            file: "angles.csv".to_owned(),
            crc32: 0,
        },
        observations,
        has_stage,
        camera,
        estimated: &ESTIMATED,
        sigma_angle_rad: SIGMA_ANGLE,
        keeps_all: true,
    })
}

fn calibrated(observations: &[FieldDirection], has_stage: bool) -> FieldAngles {
    calibrated_by(&nominal(), observations, has_stage).unwrap()
}

fn refused(observations: &[FieldDirection], has_stage: bool) -> String {
    let failure = calibrated_by(&nominal(), observations, has_stage).unwrap_err();
    match failure {
        CalibrationFailure::Input(error) => {
            format!("{error} ({})", error.help().unwrap_or_default())
        }
        other => other.to_string(),
    }
}

/// True values by name.
fn truth() -> Vec<(&'static str, f64)> {
    let camera = camera();
    let [x0, y0] = camera.principal_point_mm;
    let d = camera.distortion.measured_minus_ideal();
    let [s, alpha, z1, z2] = STAGE;
    vec![
        ("principal_distance_mm", camera.principal_distance_mm),
        ("x0_mm", x0),
        ("y0_mm", y0),
        ("k1", d.k1),
        ("k2", d.k2),
        ("k3", d.k3),
        ("p1", d.p1),
        ("p2", d.p2),
        ("stage_scale", s),
        ("stage_axis_angle_rad", alpha),
        ("run_out_mm_per_mm", z1),
        ("run_out_mm_per_mm2", z2),
    ]
}

#[test]
fn camera_and_stage_are_found_without_noise() {
    let found = calibrated(&directions(11, &OFFSETS, None), true);
    for (name, truth) in truth() {
        let value = found.result.parameter(name).unwrap().value;
        // 1e-9 mm at the edge of the format and of the stroke.
        let reach = match name {
            "k1" => 27_f64.powi(3),
            "k2" => 27_f64.powi(5),
            "k3" => 27_f64.powi(7),
            "p1" | "p2" => 27_f64.powi(2),
            _ => 1.0,
        };
        assert!(
            (value - truth).abs() * reach < 1e-9,
            "{name} {value} {truth}"
        );
    }
    let calibrated = &found.result.calibrated;
    let flatness = calibrated.flatness_um.as_ref().unwrap();
    let expected = [1.5, 0.8, -1.2];
    assert_eq!(flatness.len(), expected.len());
    for (um, expected) in flatness.iter().zip(expected) {
        assert!((um - expected).abs() < 1e-6, "{um} {expected}");
    }
    assert_eq!(found.stage.unwrap().offsets, 5);
    // Without offsets the rest of the run-out, 1.5 µm, still counts.
    let found = calibrated(&directions(11, &[0.0], None), false);
    for (name, truth) in truth().into_iter().take(3) {
        let value = found.result.parameter(name).unwrap().value;
        assert!((value - truth).abs() < 1e-9, "{name} {value} {truth}");
    }
    assert_eq!(found.result.calibrated.flatness_um, None);
    assert!(
        found.result.warnings.is_empty(),
        "{:?}",
        found.result.warnings
    );
}

#[test]
fn sigma_is_that_of_the_document() {
    let sigma = |found: &FieldAngles, name: &str| found.result.sigma_a_priori(name).unwrap();
    let one = calibrated(&directions(11, &[0.0], None), false);
    let five = calibrated(&directions(11, &OFFSETS, None), true);
    for name in ["principal_distance_mm", "x0_mm", "y0_mm"] {
        println!(
            "{name} {:.3} {:.3}",
            1e3 * sigma(&one, name),
            1e3 * sigma(&five, name)
        );
    }
    for name in [
        "stage_scale",
        "stage_axis_angle_rad",
        "run_out_mm_per_mm",
        "run_out_mm_per_mm2",
    ] {
        println!("{name} {:.4e}", sigma(&five, name));
    }
    println!("{:?}", five.mount);
}
