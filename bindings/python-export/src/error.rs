//! Errors as exceptions of `fmc_camera`, each with its numbers as attributes.

use std::io;
use std::path::Path;

use fmc_camera_file::InputError;
use fmc_output::error_number;
use pyo3::exceptions::{PyFileExistsError, PyOSError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Returns the error of a sentence alone.
pub(crate) fn of_text(text: impl Into<String>) -> PyErr {
    of("Error", &text.into(), |_| Ok(()))
}

/// Returns the error of an input file.
pub(crate) fn of_input(error: &InputError) -> PyErr {
    let help = error.help();
    let text = help.map_or_else(|| error.to_string(), |help| format!("{error} ({help})"));
    of("InvalidFile", &text, |fields| fields.set_item("help", help))
}

/// Returns the error of a number outside its range; `range` is that in words.
pub(crate) fn of_number(quantity: &str, value: f64, [least, most]: [f64; 2], range: &str) -> PyErr {
    let text = format!("{quantity} = {value} is {range}");
    of("OutOfRange", &text, |fields| {
        fields.set_item("quantity", quantity)?;
        fields.set_item("value", value)?;
        fields.set_item("least", least)?;
        fields.set_item("most", most)
    })
}

/// Returns the error of a file that cannot be written: Python's own.
pub(crate) fn of_writing(path: &Path, error: &io::Error) -> PyErr {
    let made = Python::attach(|py| {
        // Windows has numbers of its own.
        let number = error.raw_os_error().filter(|_| cfg!(not(windows)));
        let number = match (number, error_number::name(error)) {
            (Some(number), _) => number,
            (None, Some(name)) => py.import("errno")?.getattr(name)?.extract()?,
            (None, None) => {
                return Ok(PyOSError::new_err(format!("{}: {error}", path.display())));
            }
        };
        let text = py.import("os")?.call_method1("strerror", (number,))?;
        let arguments = (number, text.unbind(), path.display().to_string());
        Ok(PyOSError::new_err(arguments))
    });
    made.unwrap_or_else(|other: PyErr| other)
}

/// Returns the error of a file that is there and may not be replaced: Python's own.
pub(crate) fn of_existing(path: &Path) -> PyErr {
    let number = Python::attach(|py| {
        let number = py.import("errno")?.getattr("EEXIST")?;
        number.extract::<i32>()
    });
    let name = path.display().to_string();
    number.map_or_else(
        |other| other,
        |number| PyFileExistsError::new_err((number, "exists, and overwrite is not True", name)),
    )
}

/// Returns an exception of a class of `fmc_camera` with attributes.
fn of(class: &str, text: &str, fill: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    let made = Python::attach(|py| {
        let error = py.import("fmc_camera")?.getattr(class)?.call1((text,))?;
        let fields = PyDict::new(py);
        fill(&fields)?;
        for (name, value) in fields {
            error.setattr(name.extract::<&str>()?, value)?;
        }
        Ok(PyErr::from_value(error))
    });
    // What keeps an exception from being made is one itself.
    made.unwrap_or_else(|other| other)
}
