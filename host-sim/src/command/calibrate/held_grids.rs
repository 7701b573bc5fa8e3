//! Residual grids of a camera file that a calibration holds: they take part in its observation
//! equations, and stay in the camera file that it writes.

use std::path::Path;

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_camera::geometry::grid::{GridCarrier, ResidualGrid};
use fmc_camera_file::grid_block::{NamedFiles, file_name, with_copies, without_grids};
use fmc_camera_file::static_block::{StaticCalibration, with_calibration};
use fmc_camera_file::{CameraFile, GridFiles, GridRefusal, InputError};
use fmc_reference::residual_splines::ResidualSplines;
use fmc_report::calibration::result::of_method::OfMethod;
use serde_json::json;

use crate::failure::Failure;

/// Parts that can have a grid, with their keys in `[grid]`.
const PARTS: [(GridCarrier, &str); 2] =
    [(GridCarrier::Lens, "lens"), (GridCarrier::Sensor, "sensor")];

/// Residual grids that are held; none for a camera without.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldGrids {
    files: GridFiles,
    splines: ResidualSplines,
}

impl HeldGrids {
    /// Reads a camera file with its residual grids, and prints the warning of
    /// [`read_camera`](crate::command::read_camera).
    pub(super) fn read(path: &Path) -> Result<(CameraFile, Self), Failure> {
        let (camera, checked, files) = CameraFile::read_with_grids(path)?;
        crate::command::warn_of_distortion(path, &camera);
        let splines = {
            let grids = files.grids(checked.calibration());
            ResidualSplines::of(&grids.map_err(|refusal| refused(path.display(), &refusal))?)
        };
        Ok((camera, Self { files, splines }))
    }

    /// Returns true for a camera without residual grids.
    pub(super) const fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The grids in double precision.
    pub(super) const fn splines(&self) -> &ResidualSplines {
        &self.splines
    }

    /// Says in the result, in `summary.json` and on the page that the polynomial belongs with these
    /// grids.
    pub(super) fn state(&self, result: &mut CalibrationResult, of_method: &mut OfMethod) {
        if self.is_empty() {
            return;
        }
        let (mut named, mut keys) = (Vec::new(), Vec::new());
        for (key, carrier, crc32) in self.parts() {
            named.push(format!("{key} (CRC-32 {crc32})"));
            keys.push(json!({"frame": key, "file": file_name(carrier), "crc32": crc32}));
        }
        result.notes.push(format!(
            "the residual grids of the camera file were held: {}; this polynomial belongs with them, and with no others",
            named.join(" and ")
        ));
        of_method
            .summary
            .insert("held_grids".to_owned(), json!(keys));
    }

    /// Returns the text of a camera file with a calibration and with these grids, whose copies lie
    /// beside it, and the copies.
    ///
    /// # Errors
    /// [`InputError`] for a camera that no correction accepts, such as a polynomial with which the
    /// grids fold the image.
    pub(super) fn camera_file(
        &self,
        name: &str,
        text: &str,
        calibrated: &StaticCalibration,
    ) -> Result<(String, NamedFiles), InputError> {
        with_grids(name, text, calibrated, &self.files)
    }

    /// Key, part and CRC-32 of every grid.
    fn parts(&self) -> impl Iterator<Item = (&'static str, GridCarrier, String)> {
        PARTS.into_iter().filter_map(|(carrier, key)| {
            let grid = ResidualGrid::parse(self.files.bytes(carrier)?).ok()?;
            Some((key, carrier, format!("{:08x}", grid.crc32())))
        })
    }
}

/// Returns the text of a camera file with a calibration and with grids, and the files of the grids;
/// those that `text` names are replaced.
///
/// # Errors
/// As [`HeldGrids::camera_file`].
pub(super) fn with_grids(
    name: &str,
    text: &str,
    calibrated: &StaticCalibration,
    grids: &GridFiles,
) -> Result<(String, NamedFiles), InputError> {
    if grids.is_empty() {
        return Ok((with_calibration(name, text, calibrated)?, NamedFiles::new()));
    }
    let text = with_calibration(name, &without_grids(name, text)?, calibrated)?;
    let (_, camera) = CameraFile::parse(name, &text)?;
    grids
        .grids(camera.calibration())
        .map_err(|refusal| refused(format!("{name} with the calibration"), &refusal))?;
    with_copies(name, &text, grids)
}

/// Adds the files of grids to those of a calibration; returns the names of those that a former
/// calibration may have left.
pub(super) fn add_files(of_method: &mut OfMethod, grids: &[(String, Vec<u8>)]) -> Vec<String> {
    of_method.files.extend(grids.iter().cloned());
    let is_left = |name: &String| grids.iter().all(|(own, _)| own != name);
    let names = PARTS.map(|(carrier, _)| file_name(carrier).to_owned());
    names.into_iter().filter(is_left).collect()
}

fn refused(name: impl std::fmt::Display, refusal: &GridRefusal) -> InputError {
    InputError::invalid(format!("{name}: [grid]: {refusal}"))
}
