//! rectified-camera.toml: the one camera of all rectified frames.

use fmc_camera_file::CameraFile;
use serde::Serialize;

use crate::failure::Failure;

/// Name of the file.
pub(super) const NAME: &str = "rectified-camera.toml";

/// A camera file without distortion, whose principal point is the centre of the image.
#[derive(Debug, Serialize)]
struct RectifiedCamera {
    name: String,
    principal_distance_mm: f64,
    principal_point_mm: [f64; 2],
    sensor: Sensor,
}

#[derive(Debug, Serialize)]
struct Sensor {
    width_px: u32,
    height_px: u32,
    pixel_um: f64,
}

/// Returns the text of the file.
///
/// # Errors
/// [`Failure`] if it cannot be written as TOML.
pub(super) fn text(
    camera: &CameraFile,
    [width_px, height_px]: [u32; 2],
) -> Result<String, Failure> {
    let rectified = RectifiedCamera {
        name: format!("{}, rectified", camera.name),
        principal_distance_mm: camera.principal_distance_mm,
        principal_point_mm: [0.0; 2],
        sensor: Sensor {
            width_px,
            height_px,
            pixel_um: camera.sensor.pixel_um,
        },
    };
    let table = toml::to_string(&rectified)
        .map_err(|error| Failure::device_or_io(format!("{NAME}: {error}")))?;
    Ok(format!(
        "# Camera of the rectified frames: no distortion, and the principal point of every\n\
         # exposure is the centre of its image.\n{table}"
    ))
}
