//! Files of other programs for `fmc_camera` in Python: what `Camera.export` calls.
//!
//! It is a wheel of its own, so that the one with the camera stays small. It takes the text of a
//! camera file and writes, byte by byte, the files of `host-sim export`. Guide: `docs/python.md`.

#![forbid(unsafe_code)]

mod error;
mod images;
mod options;
mod request;
mod written;

use pyo3::prelude::*;

/// Module of the compiled part.
#[pymodule]
mod fmc_camera_export {
    use pyo3::exceptions::PyUserWarning;
    use pyo3::prelude::*;

    use crate::request::Request;
    use crate::{error, written};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    /// Writes files, which appear together, and returns the statement of what they hold.
    #[pyfunction]
    fn write(py: Python<'_>, request: Request) -> PyResult<Bound<'_, PyAny>> {
        let export = request.checked(py)?;
        let summary = py.detach(|| export.write())?;
        if let Some(warning) = written::warning(&summary) {
            let text = std::ffi::CString::new(warning)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
        }
        let statement = serde_json::to_string(&summary)
            .map_err(|fault| error::of_text(format!("export: {fault}")))?;
        py.import("json")?.call_method1("loads", (statement,))
    }
}
