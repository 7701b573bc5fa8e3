//! The camera in Python: `fmc_camera._core`, which the package `fmc_camera` shows to users.
//!
//! The classes are those of `fmc-python-objects`. This crate is what the whole is linked into, and
//! that is optimised as this crate is: for speed, except for what its own crates have for size.

#![forbid(unsafe_code)]

use pyo3::prelude::*;

/// Module of the compiled part.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    fmc_python_objects::add_to(module)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
