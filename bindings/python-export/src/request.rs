//! What is to be written, as the package `fmc_camera` asks for it.

use std::collections::HashMap;
use std::path::PathBuf;

use fmc_camera_file::{CameraFile, InputError};
use fmc_frames::FrameCamera;
use pyo3::prelude::*;

use crate::images;
use crate::written::{Export, ExportedFrames, Records};
use crate::{error, options};

/// Files that are asked for: a camera, and the arguments of `Camera.export`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Request {
    /// Text of the camera file.
    text: String,
    /// Name of the camera file, in messages.
    name: String,
    /// Bytes of the residual grids by the names of their files.
    grids: HashMap<String, Vec<u8>>,
    program: String,
    folder: PathBuf,
    model: Option<String>,
    container: Option<String>,
    binary: bool,
    id: Option<String>,
    max_residual_um: Option<f64>,
    overwrite: bool,
    /// Name of the records in messages, if there are any.
    records_name: Option<String>,
    records_file: Option<PathBuf>,
    /// Records in memory, as a file of CSV.
    records_table: Option<Vec<u8>>,
    images: Option<Py<PyAny>>,
}

impl Request {
    /// Reads and checks the arguments, and the camera.
    ///
    /// # Errors
    /// `fmc_camera.Error` for a program, a container or a pattern that there is not, and for options
    /// that do not fit the program; `fmc_camera.OutOfRange` for a residual that is no length.
    pub(crate) fn checked(self, py: Python<'_>) -> PyResult<Export> {
        let program = options::program(&self.program)?;
        if let Some(limit) = self.max_residual_um
            && (limit.is_nan() || limit <= 0.0)
        {
            let range = [0.0, f64::INFINITY];
            return Err(error::of_number(
                "max_residual_um",
                limit,
                range,
                "not above 0",
            ));
        }
        let container = self.container.as_deref();
        let container = container.map(options::container).transpose()?;
        let (name, text) = (&self.name, &self.text);
        let grid = |grid: &str| {
            let bytes = self.grids.get(grid).cloned();
            bytes.ok_or_else(|| InputError::invalid(format!("{name}: no grid {grid}")))
        };
        let (file, _, grids) = CameraFile::parse_with_grids(name, text, &grid)
            .map_err(|error| error::of_input(&error))?;
        let camera =
            FrameCamera::with_grids(name, &file, grids).map_err(|error| error::of_input(&error))?;
        let mut export = Export {
            text: self.text,
            file,
            camera,
            program,
            folder: self.folder,
            model: self.model,
            container,
            is_binary: self.binary,
            id: self.id,
            max_residual_um: self.max_residual_um,
            overwrite: self.overwrite,
            frames: None,
        };
        let misfit = export.choices().check(program, self.records_name.is_some());
        misfit.map_err(|misfit| options::misfit(misfit, program))?;
        let records = match (self.records_file, self.records_table) {
            (Some(path), _) => Some(Records::File(path)),
            (None, Some(bytes)) => Some(Records::Table(bytes)),
            (None, None) => None,
        };
        if let (Some(name), Some(records)) = (self.records_name, records) {
            let (images, images_from) =
                images::named(self.images.as_ref().map(|images| images.bind(py)))?;
            export.frames = Some(ExportedFrames {
                name,
                records,
                images,
                images_from,
            });
        }
        Ok(export)
    }
}
