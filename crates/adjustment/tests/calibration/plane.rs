//! Simulated images of a plane target: the camera of Feng et al., 2160 x 1440 pixels.

use std::sync::Arc;

use fmc_adjustment::calibration::dlt2d::distortion_table::Dlt2d;
use fmc_adjustment::calibration::dlt2d::dlt2d;
use fmc_adjustment::calibration::dlt2d::request::{Dlt2dRequest, PlaneTarget};
use fmc_adjustment::calibration::dlt3d::pinhole::Pinhole;
use fmc_adjustment::calibration::failure::CalibrationFailure;
use fmc_adjustment::calibration::result::InputFile;
use fmc_camera_file::CameraFile;
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{Rotation3, Vector3};

use crate::noise::Noise;
use crate::scene::measured;

/// Half of the format, mm.
pub(crate) const HALF: [f64; 2] = [6.75, 4.5];
/// f, mm.
pub(crate) const F: f64 = 20.0;
/// K1 of 1 % at the corner, mm⁻².
pub(crate) const K1: f64 = -0.01 / (6.75 * 6.75 + 4.5 * 4.5);

/// A lens of 1 % with decentring, 1 m above the target, tilted.
pub(crate) fn tilted() -> Pinhole {
    Pinhole {
        principal_point_mm: [0.03, -0.02],
        decentring: [2e-5, -1e-5],
        camera_from_ground: Rotation3::from_euler_angles(0.05, -0.08, 0.02).into_inner(),
        ..untilted()
    }
}

/// A lens of 1 % and K1 alone, straight above the middle of the target.
pub(crate) fn untilted() -> Pinhole {
    Pinhole {
        principal_distance_mm: F,
        principal_point_mm: [0.0; 2],
        affinity: [0.0; 2],
        radial: [K1, 0.0, 0.0],
        decentring: [0.0; 2],
        centre_m: Vector3::new(0.0, 0.0, 1.0),
        camera_from_ground: Rotation3::identity().into_inner(),
    }
}

/// Camera file with the principal point of a camera and no distortion.
pub(crate) fn nominal(camera: &Pinhole) -> CameraFile {
    let [x0, y0] = camera.principal_point_mm;
    let text = format!(
        "name = \"still\"\nprincipal_distance_mm = {F}\nprincipal_point_mm = [{x0}, {y0}]\n[sensor]\nwidth_px = 2160\nheight_px = 1440\npixel_um = 6.25\n"
    );
    CameraFile::parse("camera.toml", &text).unwrap().0
}

/// Targets of 15 columns and 10 rows over the format, with noise, µm.
pub(crate) fn targets(camera: &Pinhole, noise_um: f64, seed: u64) -> Vec<PlaneTarget> {
    let mut noise = Noise::new(seed);
    (0..150_u32)
        .map(|index| {
            let [column, row] = [index % 15, index / 15].map(f64::from);
            // The image of the lattice nearly fills the format.
            let plane_m = [
                0.96 * HALF[0] / F * (column / 7.0 - 1.0),
                0.96 * HALF[1] / F * (row / 4.5 - 1.0),
            ];
            let [x, y] = measured(camera, [plane_m[0], plane_m[1], 0.0]);
            PlaneTarget {
                line: u64::from(index) + 2,
                target: Arc::from(format!("{:03}", index + 1)),
                measured_mm: [
                    x + 1e-3 * noise_um * noise.gaussian(),
                    y + 1e-3 * noise_um * noise.gaussian(),
                ],
                sigma_mm: 1e-3,
                plane_m,
            }
        })
        .collect()
}

/// Names of the corner targets.
pub(crate) fn corners() -> [String; 4] {
    ["001", "015", "136", "150"].map(str::to_owned)
}

/// Returns the request of a table.
pub(crate) fn request<'a>(
    targets: &'a [PlaneTarget],
    camera: &'a CameraFile,
    corners: Option<&'a [String; 4]>,
) -> Dlt2dRequest<'a> {
    Dlt2dRequest {
        input: InputFile {
            file: "targets.csv".to_owned(),
            crc32: 0,
        },
        has_sigma: false,
        focus: None,
        targets,
        camera,
        grids: &ResidualSplines::NONE,
        corners,
        is_estimated: [true; 5],
        keeps_all: false,
    }
}

/// Determines a table.
pub(crate) fn tabulated(
    targets: &[PlaneTarget],
    camera: &CameraFile,
    corners: Option<&[String; 4]>,
) -> Result<Dlt2d, CalibrationFailure> {
    dlt2d(&request(targets, camera, corners))
}
