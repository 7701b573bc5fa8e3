//! Cameras with residual grids in the laboratory: directions, a spatial field and a plane find the
//! camera beside the grids that are held, and not without them.

use fmc_adjustment::bundle::interior::Interior;
use fmc_adjustment::calibration::dlt2d::dlt2d;
use fmc_adjustment::calibration::dlt2d::request::Dlt2dRequest;
use fmc_adjustment::calibration::dlt3d::pinhole::{INTERIOR_NAMES, Pinhole};
use fmc_adjustment::calibration::dlt3d::{Dlt3d, Dlt3dRequest, dlt3d};
use fmc_adjustment::calibration::result::InputFile;
use fmc_adjustment::field_angles::{FieldAngles, FieldAnglesRequest, FieldDirection, field_angles};
use fmc_reference::residual_spline::ResidualSpline;
use fmc_reference::residual_splines::ResidualSplines;

use crate::field_angles::{
    ESTIMATED, OFFSETS, SIGMA_ANGLE, STAGE, camera, directions, largest_error, nominal,
};
use crate::plane::{self, targets, tilted};
use crate::scene::{self, IXM_50, observed};

const NONE: ResidualSplines = ResidualSplines::NONE;

/// Waves of lens and sensor of these sizes over ±31 mm, 12 to 25 mm long for a pitch of 2 mm.
fn grids([of_lens, of_sensor]: [f64; 2], pitch_mm: f64) -> ResidualSplines {
    let spline = |size: f64, phase: f64| {
        let nodes = (0..1024_u16).map(|node| {
            let [column, row] = [node % 32, node / 32].map(f64::from);
            [
                size * (0.6 * column + 0.3 * row + phase).sin(),
                size * (0.5 * row - 0.8 * column + 2.0 * phase).cos(),
            ]
        });
        ResidualSpline::new([-15.5 * pitch_mm; 2], pitch_mm, 32, nodes.collect())
    };
    ResidualSplines::new(Some(spline(of_lens, 0.4)), Some(spline(of_sensor, 1.7)))
}

/// Place of a lens over the sensor.
struct Place {
    principal_point_mm: [f64; 2],
    /// Motion of the principal point, mm.
    motion_mm: [f64; 2],
    /// 1+κ.
    scale: f64,
}

/// Returns the measured point of a camera with grids whose ideal point is that of a measured point
/// of the same camera without: ρ - D(ρ) - G = ρ' - D(ρ'), by iteration.
fn measured(
    without: [f64; 2],
    place: &Place,
    distortion: impl Fn([f64; 2]) -> [f64; 2],
    grids: &ResidualSplines,
) -> [f64; 2] {
    let ([x0, y0], [mx, my]) = (place.principal_point_mm, place.motion_mm);
    let [x, y] = without;
    let mut rho = [x - x0 - mx, y - y0 - my].map(|mm| mm / place.scale);
    let [dx, dy] = distortion(rho);
    let aim = [rho[0] - dx, rho[1] - dy];
    let point = |rho: [f64; 2]| {
        [
            x0 + mx + place.scale * rho[0],
            y0 + my + place.scale * rho[1],
        ]
    };
    for _ in 0..200 {
        let [x, y] = point(rho);
        let of_lens = grids.of_lens([x - mx, y - my].map(|mm| mm / place.scale));
        let of_sensor = grids.of_sensor([x, y]);
        let distortion = distortion(rho);
        rho = [0, 1].map(|axis| aim[axis] + distortion[axis] + of_lens[axis] + of_sensor[axis]);
    }
    point(rho)
}

/// Returns the directions of the stage's calibration through the lens with grids.
fn seen(grids: &ResidualSplines, noise: Option<u64>) -> Vec<FieldDirection> {
    let camera = camera();
    let interior = Interior::of(&camera);
    let mut all = directions(11, &OFFSETS, noise);
    for one in &mut all {
        let ([s, alpha, z1, z2], c) = (STAGE, one.stage_offset_mm);
        let place = Place {
            principal_point_mm: interior.principal_point_mm,
            motion_mm: [(1.0 + s) * c * alpha.sin(), -(1.0 + s) * c * alpha.cos()],
            scale: 1.0 + (1.5e-3 + z1 * c + z2 * c * c) / camera.exit_pupil_mm(),
        };
        let distortion = |rho| interior.distortion(rho).into();
        one.measured_mm = measured(one.measured_mm, &place, distortion, grids);
    }
    all
}

fn calibrated(observations: &[FieldDirection], grids: &ResidualSplines) -> FieldAngles {
    field_angles(&FieldAnglesRequest {
        input: InputFile {
            file: "angles.csv".to_owned(),
            crc32: 0,
        },
        observations,
        has_stage: true,
        camera: &nominal(),
        grids,
        estimated: &ESTIMATED,
        sigma_angle_rad: SIGMA_ANGLE,
        keeps_all: true,
    })
    .unwrap()
}

/// The grid of the lens goes with the stage that is found, not with that of the camera file.
#[test]
fn turntable_finds_camera_and_stage_beside_the_grids() {
    let grids = grids([5e-3, 3e-3], 2.0);
    let exact = seen(&grids, None);
    let error = largest_error(&calibrated(&exact, &grids));
    assert!(error < 1e-9, "{error}");
    let error = largest_error(&calibrated(&exact, &NONE));
    assert!(error > 1e-3, "{error}");
    let noisy = seen(&grids, Some(3));
    let sigma0 = |held: &ResidualSplines| calibrated(&noisy, held).result.sigma0;
    let with = sigma0(&grids);
    // 1210 observations: 0.02 is one of its σ.
    assert!((with - 1.0).abs() < 0.06, "{with}");
    assert!(sigma0(&NONE) > 4.0);
}

fn distortion_of(camera: &Pinhole) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |rho| camera.radial_and_decentring(rho).0
}

#[test]
fn spatial_field_finds_the_camera_beside_the_grids() {
    let grids = grids([5e-3, 3e-3], 2.0);
    let camera = IXM_50.pinhole([0.0, 0.0, 6.5], [0.0; 3]);
    let objects = scene::field(120, [5.2, 3.8, 3.0], [0.0; 3], 4);
    let mut points = observed(&camera, &objects, 0.0, 1);
    let place = Place {
        principal_point_mm: camera.principal_point_mm,
        motion_mm: [0.0; 2],
        scale: 1.0,
    };
    for one in &mut points {
        one.measured_mm = measured(one.measured_mm, &place, distortion_of(&camera), &grids);
    }
    let nominal = IXM_50.nominal();
    let found = |grids: &ResidualSplines| -> Dlt3d {
        dlt3d(&Dlt3dRequest {
            grids,
            keeps_all: true,
            ..scene::request(&points, &nominal, [true; 5])
        })
        .unwrap()
    };
    let largest_error = |found: &Dlt3d| {
        let pairs = found.camera.interior().into_iter().zip(camera.interior());
        let named = INTERIOR_NAMES.into_iter().zip(pairs);
        let errors = named.map(|(name, (found, truth))| {
            let reach = match name {
                "k1" => 27_f64.powi(3),
                "k2" => 27_f64.powi(5),
                "k3" => 27_f64.powi(7),
                "p1" | "p2" => 27_f64.powi(2),
                "b1" | "b2" => 27.0,
                _ => 1.0,
            };
            reach * (found - truth).abs()
        });
        errors.fold(0.0, f64::max)
    };
    let with = found(&grids);
    assert!(largest_error(&with) < 1e-8, "{}", largest_error(&with));
    let (_, residual) = with.result.residual_size_mm().unwrap();
    assert!(residual < 1e-11, "{residual}");
    let without = found(&NONE);
    assert!(
        largest_error(&without) > 1e-3,
        "{}",
        largest_error(&without)
    );
    assert!(without.result.residual_size_mm().unwrap().1 > 3e-3);
}

/// The table is of the whole distortion; the polynomial stands beside the grids.
#[test]
fn plane_target_finds_the_polynomial_beside_the_grids_and_a_table_of_both() {
    let grids = grids([1e-3, 5e-4], 0.5);
    let camera = tilted();
    let mut targets = targets(&camera, 0.0, 1);
    let place = Place {
        principal_point_mm: camera.principal_point_mm,
        motion_mm: [0.0; 2],
        scale: 1.0,
    };
    for one in &mut targets {
        one.measured_mm = measured(one.measured_mm, &place, distortion_of(&camera), &grids);
    }
    let nominal = plane::nominal(&camera);
    let found = |grids: &ResidualSplines| {
        dlt2d(&Dlt2dRequest {
            grids,
            keeps_all: true,
            ..plane::request(&targets, &nominal, None)
        })
        .unwrap()
    };
    let with = found(&grids);
    let k1 = |found: &fmc_adjustment::calibration::dlt2d::distortion_table::Dlt2d| {
        found.result.parameter("k1").unwrap().value
    };
    assert!((k1(&with) - plane::K1).abs() < 1e-12, "{}", k1(&with));
    let (_, residual) = with.result.residual_size_mm().unwrap();
    assert!(residual < 1e-12, "{residual}");
    let distortion = distortion_of(&camera);
    let [x0, y0] = camera.principal_point_mm;
    for row in &with.rows {
        let [x, y] = row.measured_mm;
        let expected = distortion([x - x0, y - y0]);
        let added = grids.calibrated([x, y]);
        for axis in 0..2 {
            let error = row.of_camera_mm[axis] - expected[axis] - added[axis];
            assert!(error.abs() < 1e-11, "{error}");
        }
    }
    let without = found(&NONE);
    assert!((k1(&without) - plane::K1).abs() > 1e-7, "{}", k1(&without));
    assert!(without.result.residual_size_mm().unwrap().1 > 3e-4);
    // The table is the image's, whatever the camera holds.
    for (a, b) in with.rows.iter().zip(&without.rows) {
        assert_eq!(
            a.distortion_mm.map(f64::to_bits),
            b.distortion_mm.map(f64::to_bits)
        );
    }
}
