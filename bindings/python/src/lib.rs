//! The camera in Python: `fmc_camera._core`, which the package `fmc_camera` shows to users.
//!
//! It converts between Python's objects and those of the libraries, and computes nothing of its
//! own: coordinates have the bits of the library in Rust. Guide: `docs/python.md`.

#![forbid(unsafe_code)]

mod answer;
mod array;
mod camera;
mod camera_keys;
mod choice;
mod columns;
mod coordinate;
mod correction_kernel;
mod error;
mod exposure;
mod flight_points;
mod frame;
mod frame_corrections;
mod frame_in_use;
mod frame_points;
mod frames;
mod index;
mod mesh;
mod off_sensor;
mod pixels;
mod record_source;
mod reference;
mod table_cells;

use pyo3::prelude::*;

/// Module of the compiled part.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    error::register(module)?;
    module.add_class::<camera::Camera>()?;
    module.add_class::<frame::Frame>()?;
    module.add_class::<frames::Frames>()?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
