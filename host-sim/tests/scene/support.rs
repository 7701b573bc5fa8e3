//! Cameras, points and scenes of the tests.

use fmc_camera_file::published::CAMERA_FILES;
use fmc_camera_file::{CameraFile, Strategy};
use fmc_simulation::scene::Scene;
use fmc_simulation::scene::exposure::ExposedScene;

pub(crate) const HEIGHT_M: f64 = 1000.0;

/// Returns the five published cameras, with both strategies.
pub(crate) fn published() -> Vec<CameraFile> {
    CAMERA_FILES
        .iter()
        .map(|(file, text)| CameraFile::parse(file, text).unwrap().0)
        .flat_map(|camera| {
            Strategy::ALL.map(|strategy| {
                let mut camera = camera.clone();
                camera.fmc.strategy = Some(strategy);
                camera
            })
        })
        .collect()
}

/// Returns a camera of 80.64 mm square behind 100 mm, with `more` in its file.
pub(crate) fn square(more: &str) -> CameraFile {
    let text = format!(
        "name = \"square\"\nprincipal_distance_mm = 100.0\n\
         [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n{more}"
    );
    CameraFile::parse("square.toml", &text).unwrap().0
}

/// Returns `count` x `count` points over that share of the sensor's sides.
pub(crate) fn points(camera: &CameraFile, count: u8, share: f64) -> Vec<[f64; 2]> {
    let half = camera.half_format_mm();
    let place = |index: u8| 2.0 * f64::from(index) / f64::from(count - 1) - 1.0;
    (0..count)
        .flat_map(|row| {
            (0..count).map(move |column| {
                [
                    half[0] * share * place(column),
                    half[1] * share * place(row),
                ]
            })
        })
        .collect()
}

/// Returns the point of the ground at height 0 below an ideal point of the sensor frame at the
/// centroid, for a level camera.
pub(crate) fn ground_below(
    scene: &Scene,
    frame: &ExposedScene<'_>,
    ideal_mm: [f64; 2],
) -> [f64; 3] {
    let [x0, y0] = frame.principal_point_mm();
    let [eye_x, eye_y, eye_z] = frame.projection_centre_m();
    let relative = [ideal_mm[0] - x0, ideal_mm[1] - y0];
    let [right, forward] = scene.interior.camera_from_sensor(relative);
    let scale = eye_z / scene.interior.principal_distance_mm;
    [eye_x + scale * right, eye_y + scale * forward, 0.0]
}

/// Returns the length of the difference.
pub(crate) fn apart([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    (ax - bx).hypot(ay - by)
}
