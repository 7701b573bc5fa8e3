//! Files of other programs, which another wheel writes: most users need none, and it is nearly as
//! large as this one.

use std::path::PathBuf;

use pyo3::exceptions::{PyImportError, PyModuleNotFoundError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::camera::CameraParts;
use crate::error;
use crate::record_source::RecordSource;

/// Module of that wheel.
const MODULE: &str = "fmc_camera_export";

/// This wheel's version, which that of the other must be.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Options of `Camera.export`, as they are given.
pub(crate) struct Options<'a, 'py> {
    pub(crate) model: Option<String>,
    pub(crate) container: Option<String>,
    pub(crate) binary: bool,
    pub(crate) id: Option<String>,
    pub(crate) max_residual_um: Option<f64>,
    pub(crate) records: Option<&'a Bound<'py, PyAny>>,
    pub(crate) images: Option<&'a Bound<'py, PyAny>>,
    pub(crate) overwrite: bool,
}

/// Writes the files of a camera, or of its frames, and returns the statement of what they hold.
///
/// # Errors
/// `ModuleNotFoundError` without the other wheel, and that wheel's.
pub(crate) fn export<'py>(
    py: Python<'py>,
    camera: &CameraParts,
    program: String,
    folder: PathBuf,
    options: Options<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    if options.images.is_some() && options.records.is_none() {
        return Err(error::of_text("images: given without records"));
    }
    let write = module(py)?.getattr("write")?;
    let request = PyDict::new(py);
    request.set_item("text", &camera.text)?;
    request.set_item("name", &camera.name)?;
    request.set_item("grids", camera.grid_bytes(py)?)?;
    request.set_item("program", program)?;
    request.set_item("folder", folder)?;
    request.set_item("model", options.model)?;
    request.set_item("container", options.container)?;
    request.set_item("binary", options.binary)?;
    request.set_item("id", options.id)?;
    request.set_item("max_residual_um", options.max_residual_um)?;
    request.set_item("overwrite", options.overwrite)?;
    let records = options.records.map(RecordSource::of).transpose()?;
    request.set_item("records_name", records.as_ref().map(RecordSource::name))?;
    let (file, table) = match &records {
        Some(RecordSource::File(path)) => (Some(path), None),
        Some(RecordSource::Table(bytes)) => (None, Some(PyBytes::new(py, bytes))),
        None => (None, None),
    };
    request.set_item("records_file", file)?;
    request.set_item("records_table", table)?;
    request.set_item("images", options.images)?;
    write.call1((request,))
}

/// Returns the module of the other wheel.
fn module(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    let module = py.import(MODULE).map_err(|cause| {
        if !cause.is_instance_of::<PyModuleNotFoundError>(py) {
            return cause;
        }
        let error = PyModuleNotFoundError::new_err(
            "camera.export is in a package of its own, which is not installed: \
             pip install \"fmc-camera[export]\"",
        );
        error.set_cause(py, Some(cause));
        error
    })?;
    let version: String = module.getattr("__version__")?.extract()?;
    if version != VERSION {
        return Err(PyImportError::new_err(format!(
            "fmc-camera-export {version} is of another version than fmc-camera {VERSION}: \
             pip install fmc-camera-export=={VERSION}"
        )));
    }
    Ok(module)
}
