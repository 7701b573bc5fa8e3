//! Cameras for the tests, and the camera's own answer in double precision.

use fmc_camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_camera_file::published::CAMERA_FILES;

/// Returns the five published cameras.
pub(crate) fn published() -> Vec<CameraFile> {
    CAMERA_FILES
        .iter()
        .map(|(file, text)| CameraFile::parse(file, text).unwrap().0)
        .collect()
}

/// Returns a camera of 80.64 mm square behind 100 mm, with `more` in its file.
pub(crate) fn square(more: &str) -> CameraFile {
    let text = format!(
        "name = \"square\"\nprincipal_distance_mm = 100.0\nprincipal_point_mm = [0.03, -0.05]\n\
         [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n{more}"
    );
    CameraFile::parse("square.toml", &text).unwrap().0
}

/// Distortion of some per cent in which no coefficient is zero.
pub(crate) const STRONG_LENS: &str = "[distortion]\nk0 = 2e-3\nk1 = -2e-5\nk2 = 6e-9\nk3 = -1.3e-12\n\
                                      p1 = 6e-6\np2 = -9e-6\nb1 = 4e-4\nb2 = -3e-4\n";

/// Returns dx, dy of the camera in single precision, mm, and the bound of what its fold leaves out.
pub(crate) fn camera_distortion(
    camera: &CameraFile,
    exposure: &Exposure,
    [x, y]: [f32; 2],
) -> ([f64; 2], f64) {
    let camera = Camera::new(camera.parameters()).unwrap();
    let frame = camera.frame(exposure).unwrap();
    let d = frame.correction.distortion(SensorPoint::new(x, y));
    (
        [d.dx_mm, d.dy_mm].map(f64::from),
        f64::from(frame.interior.left_out_nm) * 1e-6,
    )
}

/// Returns 21 x 21 points over the sensor, as the camera receives them.
pub(crate) fn points(camera: &CameraFile) -> Vec<[f32; 2]> {
    fmc_reference::verification::grid::points(camera.half_format_mm())
        .points()
        .map(|point| [point.x_mm, point.y_mm])
        .collect()
}

/// Returns the larger component of the difference.
pub(crate) fn largest([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    (ax - bx).abs().max((ay - by).abs())
}
