//! `import --grid`: what the polynomial leaves, as a residual grid of the lens.

use std::path::Path;

use fmc_adjustment::grid::model_grid::{GOOD_ENOUGH_MM, model_grid};
use fmc_camera_file::grid_block::{GridEntry, with_grids};
use fmc_camera_file::{CameraFile, GridFiles, InputError};
use fmc_exchange::import::Imported;
use fmc_report::exchange::ImportedGrid;

use crate::failure::{Failure, note};

/// Residual that polynomial and grid may leave, nm.
const MOST_LEFT_NM: f64 = 5.0;

/// End of the name of a grid's file, beside the camera file.
const EXTENSION: &str = "grid-lens.fmcg";

/// A residual grid and its file.
#[derive(Debug)]
pub(super) struct GridOfImport {
    /// Statement of the grid.
    pub(super) statement: ImportedGrid,
    /// Bytes of its file.
    pub(super) bytes: Vec<u8>,
    entry: GridEntry,
}

impl GridOfImport {
    /// Finds the grid of an imported camera with the mechanism of a camera file; `None` if the
    /// polynomial holds the model. `file` is the name that messages use, `out` the camera file.
    ///
    /// # Errors
    /// [`Failure`] for a grid that no camera accepts.
    pub(super) fn of(
        file: &str,
        imported: &Imported,
        camera: &CameraFile,
        out: &Path,
    ) -> Result<Option<Self>, Failure> {
        let left = imported.residual;
        if 1e-3 * left.largest_um <= GOOD_ENOUGH_MM {
            note(format_args!(
                "--grid: the polynomial holds the model of {file} within {:.1} nm; no grid is needed",
                1e3 * left.largest_um
            ));
            return Ok(None);
        }
        let refused =
            |error: &dyn std::fmt::Display| InputError::invalid(format!("{file}: --grid: {error}"));
        let found = model_grid(camera, |points| imported.distortion(points))
            .map_err(|error| refused(&error))?;
        let grid = found.grid;
        let residual = imported
            .residual_with(|point| grid.spline.displacement(point))
            .ok_or_else(|| refused(&"the model folds within the sensor"))?;
        let left_nm = 1e3 * residual.largest_um;
        if left_nm > MOST_LEFT_NM {
            note(format_args!(
                "warning: {file}: the finest residual grid that a camera holds leaves up to {left_nm:.1} nm of the model, not \
                 at most {MOST_LEFT_NM} nm"
            ));
        }
        let name = out.with_extension(EXTENSION);
        let name = name.file_name().unwrap_or_default().to_string_lossy();
        Ok(Some(Self {
            statement: ImportedGrid {
                file: name.clone().into_owned(),
                crc32: format!("{:08x}", grid.crc32()),
                pitch_mm: grid.lattice.pitch_mm(),
                nodes: grid.lattice.sides(),
                polynomial_residual_max_um: left.largest_um,
                polynomial_residual_rms_um: left.rms_um,
                residual,
            },
            entry: GridEntry {
                key: grid.key(),
                file: name.into_owned(),
                crc32: grid.crc32(),
            },
            bytes: grid.bytes,
        }))
    }

    /// Returns the text of the camera file with the grid, which a camera accepts.
    ///
    /// # Errors
    /// [`InputError`] for a grid that no camera accepts; `out` is the name that it uses.
    pub(super) fn named_by(&self, out: &str, text: &str) -> Result<String, InputError> {
        let (_, camera) = CameraFile::parse(out, text)?;
        GridFiles::new(Some(self.bytes.clone()), None)
            .grids(camera.calibration())
            .map_err(|refusal| InputError::invalid(format!("{out}: [grid]: {refusal}")))?;
        with_grids(out, text, std::slice::from_ref(&self.entry))
    }
}
