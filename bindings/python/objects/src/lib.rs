//! The classes of `fmc_camera._core` in Python: camera, frames, budgets, figures, errors.
//!
//! They convert between Python's objects and those of the libraries, and compute nothing of their
//! own: coordinates have the bits of the library in Rust. What is done once for each point is in
//! `fmc-points`, which the wheel has for speed; this crate it has for size. Guide: `docs/python.md`.

#![forbid(unsafe_code)]

mod answer;
mod array;
mod budget;
mod camera;
mod camera_keys;
mod choice;
mod columns;
mod error;
mod export;
mod exposure;
mod figure;
mod flight_work;
mod frame;
mod frame_work;
mod frames;
mod index;
mod off_sensor;
mod plot;
mod record_source;
mod reference;
mod table_cells;

use pyo3::prelude::*;

/// Adds the classes to a module.
///
/// # Errors
/// Those of Python.
pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    error::register(module)?;
    module.add_class::<budget::Budget>()?;
    module.add_class::<camera::Camera>()?;
    module.add_class::<figure::Figure>()?;
    module.add_class::<frame::Frame>()?;
    module.add_class::<frames::Frames>()
}
