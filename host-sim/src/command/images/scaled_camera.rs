//! A camera with wider pixels.

use std::path::Path;

use fmc_camera_file::CameraFile;

use crate::failure::Failure;

/// Returns the text of a camera file with pixels `scale` times as wide, and so many times fewer.
///
/// # Errors
/// [`Failure`] naming the file, for an image that would have no pixels.
pub(super) fn text(path: &Path, camera: &CameraFile, scale: u16) -> Result<String, Failure> {
    let failed = |fault: String| Failure::bad_input(format!("{}: {fault}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| Failure::reading(path, &error))?;
    if scale == 1 {
        return Ok(text);
    }
    scaled(&text, camera, scale).map_err(|fault| failed(format!("--scale {scale}: {fault}")))
}

/// Returns the text of a camera with wider pixels.
///
/// # Errors
/// The fault in words.
pub(super) fn scaled(text: &str, camera: &CameraFile, scale: u16) -> Result<String, String> {
    let mut table: toml::Table = toml::from_str(text).map_err(|error| error.to_string())?;
    let sensor = table
        .get_mut("sensor")
        .and_then(toml::Value::as_table_mut)
        .ok_or("there is no table [sensor]")?;
    for (key, side) in [
        ("width_px", camera.sensor.width_px),
        ("height_px", camera.sensor.height_px),
    ] {
        let fewer = side / i64::from(scale);
        if fewer < 1 {
            return Err(format!("{key} = {side} leaves no pixel"));
        }
        sensor.insert(key.to_owned(), fewer.into());
    }
    let pixel_um = camera.sensor.pixel_um * f64::from(scale);
    sensor.insert("pixel_um".to_owned(), pixel_um.into());
    toml::to_string(&table).map_err(|error| error.to_string())
}
