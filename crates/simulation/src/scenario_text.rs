//! Text of a scenario, and the camera file that it names.

use std::path::{Path, PathBuf};

use fmc_camera_file::toml_text::TomlText;
use fmc_camera_file::{CameraFile, InputError, Strategy};

/// Reads the text of a scenario.
///
/// # Errors
/// [`InputError`] for a file that cannot be read or is no text.
pub(crate) fn read(path: &Path) -> Result<String, InputError> {
    let bytes = std::fs::read(path).map_err(|error| InputError::reading(path, &error))?;
    String::from_utf8(bytes)
        .map_err(|_| InputError::invalid(format!("{}: not a text file (UTF-8)", path.display())))
}

/// Returns the path of the camera file that a scenario names, relative to its folder.
///
/// # Errors
/// [`InputError`] at the scenario's key `camera` if the file is not there.
pub(crate) fn camera_path(
    text: &TomlText,
    folder: &Path,
    camera: &Path,
) -> Result<PathBuf, InputError> {
    let path = folder.join(camera);
    if path.is_file() {
        return Ok(path);
    }
    let fault = format!("names a camera file, {}, that is not there", path.display());
    Err(text.invalid(&["camera"], &fault))
}

/// Reads a camera file, whose run-up the scenario may replace.
///
/// # Errors
/// [`InputError`] as of [`CameraFile::read`]: the lens that is simulated is the polynomial.
pub(crate) fn camera_with(path: &Path, run_up: Option<Strategy>) -> Result<CameraFile, InputError> {
    let (mut camera, _) = CameraFile::read_polynomial(
        path,
        "the lens through which the flight is simulated is the polynomial, and a grid that simulation and adjustment share drops out",
    )?;
    if run_up.is_some() {
        camera.fmc.strategy = run_up;
    }
    Ok(camera)
}
