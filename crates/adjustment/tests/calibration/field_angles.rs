//! Precise angles of an area camera with its stage, by simulation.

use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::calibration::failure::CalibrationFailure;
use fmc_adjustment::calibration::result::InputFile;
use fmc_adjustment::field_angles::{FieldAngles, FieldAnglesRequest, FieldDirection, field_angles};
use fmc_camera_file::CameraFile;
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{Rotation3, Vector3};

use crate::noise::{Noise, binomial_half_width};

const IXM: &str = include_str!("../../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml");

/// A tenth of a pixel.
const SIGMA_MM: f64 = 0.376e-3;
/// 0.5".
pub(crate) const SIGMA_ANGLE: f64 = 0.5 / 3600.0 * std::f64::consts::PI / 180.0;

/// f, x0, y0, K1 to K3, P1, P2.
pub(crate) const ESTIMATED: [InteriorElement; 8] = [
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
pub(crate) const OFFSETS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// s, α, z1, z2.
pub(crate) const STAGE: [f64; 4] = [2e-4, -3e-4, 8e-4, -1.2e-3];

/// Rotation of the mount, rad.
const MOUNT: [f64; 3] = [0.012, -0.021, 0.017];

/// The camera before the calibration: 0.1 mm and 20 µm off, without distortion.
pub(crate) fn camera() -> CameraFile {
    let text = format!("{IXM}\n[fmc]\naxis = \"-y\"\nstroke_mm = 2.0\nflatness_um = [1.5]\n");
    CameraFile::parse("camera.toml", &text).unwrap().0
}

pub(crate) fn nominal() -> CameraFile {
    let mut camera = camera();
    camera.principal_distance_mm += 0.1;
    camera.principal_point_mm = [0.04, 0.0];
    camera.distortion.k1 *= 0.9;
    camera
}

/// Measured point of a direction: `docs/calibration.md` backwards.
fn measured(camera: &CameraFile, one: &FieldDirection, stage: [f64; 4]) -> [f64; 2] {
    let [s, alpha, z1, z2] = stage;
    let offset = one.stage_offset_mm;
    let ray = Rotation3::from_scaled_axis(Vector3::from(MOUNT)) * one.direction();
    let f_mm = camera.principal_distance_mm;
    let ideal = [-f_mm * ray.x / ray.z, -f_mm * ray.y / ray.z];
    let lens = camera.distortion.measured_minus_ideal();
    let [mut x, mut y] = ideal;
    for _ in 0..200 {
        let r2 = x * x + y * y;
        let radial = r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
        let dx = x * radial + lens.p1 * (r2 + 2.0 * x * x) + 2.0 * lens.p2 * x * y;
        let dy = y * radial + lens.p2 * (r2 + 2.0 * y * y) + 2.0 * lens.p1 * x * y;
        [x, y] = [ideal[0] + dx, ideal[1] + dy];
    }
    let flatness = camera.fmc.flatness_um.first().copied().unwrap_or(0.0) / 1e3;
    let larger = 1.0 + (flatness + z1 * offset + z2 * offset * offset) / camera.exit_pupil_mm();
    let [x0, y0] = camera.principal_point_mm;
    // e = (0, -1), turned by α.
    let e = [alpha.sin(), -alpha.cos()];
    [
        x0 + (1.0 + s) * offset * e[0] + larger * x,
        y0 + (1.0 + s) * offset * e[1] + larger * y,
    ]
}

/// Directions of a square of `side` over 95 % of the format, at these offsets of the stage.
pub(crate) fn directions(side: u32, offsets: &[f64], noise: Option<u64>) -> Vec<FieldDirection> {
    let camera = camera();
    let mut noise = noise.map(Noise::new);
    let mut gaussian = || noise.as_mut().map_or(0.0, Noise::gaussian);
    let [half_x, half_y] = camera.half_format_mm();
    let [reach_x, reach_y] = [half_x, half_y].map(|half| 0.95 * half);
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
        grids: &ResidualSplines::NONE,
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
    match &failure {
        CalibrationFailure::Input(error) => {
            format!("{error} ({})", error.help().unwrap_or_default())
        }
        CalibrationFailure::NotConverged { .. } => failure.to_string(),
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

/// Largest error of the parameters at the edge of the format and of the stroke, mm.
pub(crate) fn largest_error(found: &FieldAngles) -> f64 {
    let errors = truth().into_iter().map(|(name, truth)| {
        let reach = match name {
            "k1" => 27_f64.powi(3),
            "k2" => 27_f64.powi(5),
            "k3" => 27_f64.powi(7),
            "p1" | "p2" => 27_f64.powi(2),
            _ => 1.0,
        };
        reach * (found.result.parameter(name).unwrap().value - truth).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn camera_and_stage_are_found_without_noise() {
    let found = calibrated(&directions(11, &OFFSETS, None), true);
    let error = largest_error(&found);
    assert!(error < 1e-9, "{error}");
    let static_block = &found.result.calibrated;
    let flatness = static_block.flatness_um.as_ref().unwrap();
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
    let one = calibrated(&directions(11, &[0.0], None), false);
    let five = calibrated(&directions(11, &OFFSETS, None), true);
    // The format that the directions of the document fill is not stated: 5 %.
    let assert_near = |found: &FieldAngles, name: &str, expected: f64| {
        let sigma = found.result.sigma_a_priori(name).unwrap();
        assert!((sigma / expected - 1.0).abs() < 0.05, "{name} {sigma:e}");
    };
    for (name, without, with) in [
        ("principal_distance_mm", 0.74e-3, 0.33e-3),
        ("x0_mm", 1.27e-3, 0.57e-3),
        ("y0_mm", 0.93e-3, 0.42e-3),
    ] {
        assert_near(&one, name, without);
        assert_near(&five, name, with);
    }
    for (name, expected) in [
        ("stage_scale", 23e-6),
        ("stage_axis_angle_rad", 23e-6),
        ("run_out_mm_per_mm", 0.06e-3),
        ("run_out_mm_per_mm2", 0.10e-3),
    ] {
        assert_near(&five, name, expected);
    }
    // Five times 21 x 21: half of these.
    let many = calibrated(&directions(21, &OFFSETS, None), true);
    for (name, _) in truth() {
        if name.starts_with('k') {
            continue;
        }
        let sigma = |found: &FieldAngles| found.result.sigma_a_priori(name).unwrap();
        let ratio = sigma(&many) / sigma(&five);
        assert!((0.5..0.6).contains(&ratio), "{name} {ratio}");
    }
}

#[test]
fn one_sigma_holds_its_share_of_errors() {
    let seeds = 400_u32;
    let truth = truth();
    let mut inside = vec![0_u32; truth.len()];
    let mut squares = vec![0.0; truth.len()];
    let mut sigma0 = 0.0;
    for seed in 0..seeds {
        let found = calibrated(&directions(11, &OFFSETS, Some(u64::from(seed))), true);
        sigma0 += found.result.sigma0 / f64::from(seeds);
        for (index, (name, truth)) in truth.iter().enumerate() {
            let error = found.result.parameter(name).unwrap().value - truth;
            let sigma = found.result.sigma(name).unwrap();
            inside[index] += u32::from(error.abs() <= sigma);
            squares[index] += (error / sigma).powi(2);
        }
    }
    assert!((sigma0 - 1.0).abs() < 5e-3, "{sigma0}");
    let count = f64::from(seeds);
    for ((name, _), (inside, squares)) in truth.iter().zip(inside.into_iter().zip(squares)) {
        let share = f64::from(inside) / count;
        let ratio = f64::sqrt(squares / count);
        assert!((ratio - 1.0).abs() < 0.13, "{name} {ratio}");
        assert!(
            (share - 0.6827).abs() < binomial_half_width(count),
            "{name} {share}"
        );
    }
}

#[test]
fn two_offsets_leave_the_square_of_the_run_out() {
    let mut seen = directions(11, &[-1.0, 1.0], None);
    let found = calibrated(&seen, true);
    let square = found.result.parameter("run_out_mm_per_mm2").unwrap();
    assert!(!square.is_estimated);
    assert!(found.result.sigma("run_out_mm_per_mm").is_some());
    // Readings of an encoder at two places are no more than two offsets.
    for (index, one) in seen.iter_mut().enumerate() {
        one.stage_offset_mm += if index % 2 == 0 { 1e-5 } else { -1e-5 };
    }
    assert_eq!(calibrated(&seen, true).stage.unwrap().offsets, 2);
}

#[test]
fn gross_errors_are_rejected() {
    let mut seen = directions(11, &OFFSETS, Some(7));
    seen[40].measured_mm[0] += 0.01;
    seen[333].measured_mm[1] -= 0.02;
    let found = field_angles(&FieldAnglesRequest {
        input: InputFile {
            file: "angles.csv".to_owned(),
            crc32: 0,
        },
        observations: &seen,
        has_stage: true,
        camera: &nominal(),
        grids: &ResidualSplines::NONE,
        estimated: &ESTIMATED,
        sigma_angle_rad: SIGMA_ANGLE,
        keeps_all: false,
    })
    .unwrap();
    let rejected = found.result.image_residuals.iter();
    let rejected: Vec<u64> = rejected
        .filter(|one| one.is_rejected)
        .map(|one| one.line)
        .collect();
    assert_eq!(rejected, [42, 335]);
}

fn assert_refused(
    change: impl Fn(&mut FieldDirection),
    offsets: &[f64],
    has_stage: bool,
    words: &[&str],
) {
    let mut seen = directions(11, offsets, None);
    seen.iter_mut().for_each(change);
    let message = refused(&seen, has_stage);
    for word in words {
        assert!(message.contains(word), "{word}: {message}");
    }
}

#[test]
fn wrong_units_are_named() {
    let at_rest = |change: fn(&mut FieldDirection), words: &[&str]| {
        assert_refused(change, &[0.0], false, words);
    };
    at_rest(
        |one| {
            one.azimuth_deg = one.azimuth_deg.to_radians();
            one.elevation_deg = one.elevation_deg.to_radians();
        },
        &[
            "x_mm over the tangent of azimuth_deg",
            "azimuth_deg looks like radians",
            "allowed",
        ],
    );
    at_rest(
        |one| one.elevation_deg = one.elevation_deg.to_radians(),
        &["elevation_deg looks like radians"],
    );
    at_rest(
        |one| one.measured_mm = one.measured_mm.map(|mm| 1e3 * mm),
        &["x_mm looks like µm"],
    );
    at_rest(
        |one| one.measured_mm = one.measured_mm.map(|mm| mm / 3.76e-3),
        &["x_mm looks like pixels"],
    );
    at_rest(
        |one| one.measured_mm = one.measured_mm.map(|mm| 1e-3 * mm),
        &["x_mm looks like m"],
    );
    assert_refused(
        |one| one.stage_offset_mm *= 1e3,
        &OFFSETS,
        true,
        &["stage_offset_mm looks like µm", "0.5 to 2"],
    );
    assert_refused(
        |one| one.stage_offset_mm *= 1e-2,
        &OFFSETS,
        true,
        &["moves by 100.0", "0.5 to 2"],
    );
}

#[test]
fn wrong_directions_are_named() {
    let at_rest = |change: fn(&mut FieldDirection), words: &[&str]| {
        assert_refused(change, &[0.0], false, words);
    };
    at_rest(
        |one| one.measured_mm[1] *= -1.0,
        &["y_mm falls with elevation_deg", "y upwards"],
    );
    at_rest(
        |one| one.azimuth_deg *= -1.0,
        &["x_mm falls with azimuth_deg"],
    );
    at_rest(
        |one| one.measured_mm = one.measured_mm.map(|mm| -mm),
        &["upside down"],
    );
    at_rest(
        |one| one.measured_mm.swap(0, 1),
        &["x_mm follows elevation_deg", "exchanged"],
    );
    at_rest(
        |one| one.azimuth_deg += 60.0,
        &["60.0° from the zero", "allowed: 0 to 45"],
    );
    // The axes of the turntable in the other order.
    at_rest(
        |one| {
            let d = one.direction();
            one.azimuth_deg = d.x.asin().to_degrees();
            one.elevation_deg = d.y.atan2(-d.z).to_degrees();
        },
        &["times better", "an axis that elevation_deg turns"],
    );
    assert_refused(
        |one| one.stage_offset_mm *= -1.0,
        &OFFSETS,
        true,
        &["180.0°", "counts against fmc.axis"],
    );
    let mut camera = nominal();
    camera.fmc.axis = fmc_camera_file::Axis::PlusX;
    let failure = calibrated_by(&camera, &directions(11, &OFFSETS, None), true).unwrap_err();
    assert!(failure.to_string().contains("-90.0°"), "{failure}");
}

#[test]
fn observations_that_do_not_suffice_are_named() {
    assert_refused(
        |one| {
            one.azimuth_deg = if one.line == 9 {
                -89.5
            } else {
                one.azimuth_deg
            }
        },
        &[0.0],
        false,
        &["line 9: azimuth_deg = -89.5", "-89 to 89"],
    );
    assert_refused(
        |one| {
            one.elevation_deg = if one.line == 5 {
                f64::NAN
            } else {
                one.elevation_deg
            }
        },
        &[0.0],
        false,
        &["line 5: elevation_deg = NaN", "-89 to 89"],
    );
    assert_refused(
        |_| (),
        &[0.25, 0.25],
        true,
        &[
            "stage_offset_mm is between 0.25 and 0.25",
            "tells nothing about the stage",
        ],
    );
    let few = refused(&directions(11, &[0.0], None)[..5], false);
    assert!(
        few.contains("10 observations do not suffice for 11 unknowns"),
        "{few}"
    );
    let none = refused(&[], false);
    assert!(none.contains("0 observations do not suffice"), "{none}");
    let line: Vec<FieldDirection> = directions(11, &[0.0], None)
        .into_iter()
        .filter(|one| one.elevation_deg.abs() < 1e-9)
        .collect();
    let message = refused(&line, false);
    assert!(message.contains("lie on a line"), "{message}");
    // Four directions, many times, hold no radial distortion of three terms.
    let corners: Vec<FieldDirection> = directions(2, &[0.0; 5], None);
    let message = refused(&corners, false);
    assert!(message.contains("cannot tell"), "{message}");
    assert!(
        message.contains("k2") && message.contains("k3"),
        "{message}"
    );
}
