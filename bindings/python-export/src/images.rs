//! Names of the images of a flight.

use std::collections::BTreeMap;
use std::fmt::Display;

use fmc_exchange::frames::{ImageNames, PATTERN, Pattern};
use fmc_frames::ImageMap;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::error;

/// Returns names, and how a statement calls where they are from.
///
/// # Errors
/// `TypeError` for what is neither a pattern nor a dictionary, `fmc_camera.Error` for a pattern
/// without a sequence number, `fmc_camera.InvalidFile` for names that images cannot have.
pub(crate) fn named(given: Option<&Bound<'_, PyAny>>) -> PyResult<(ImageNames, String)> {
    let pattern = match given.map(|given| (given, given.extract::<String>())) {
        None => PATTERN.to_owned(),
        Some((_, Ok(pattern))) => pattern,
        Some((given, Err(_))) => {
            let names = given.extract().map_err(|cause| {
                let kind = given.get_type();
                let error = PyTypeError::new_err(format!(
                    "images of the type {kind}: must be a pattern of names, or a dictionary of \
                     names by sequence numbers"
                ));
                error.set_cause(given.py(), Some(cause));
                error
            })?;
            return Ok((ImageNames::Map(map_of(&names)?), "images".to_owned()));
        }
    };
    let parsed = Pattern::parse(&pattern)
        .map_err(|fault| error::of_text(format!("images = '{pattern}': {fault}")))?;
    Ok((ImageNames::Pattern(parsed), pattern))
}

/// Returns names by sequence numbers as the table that a file holds.
fn map_of(names: &BTreeMap<u32, String>) -> PyResult<ImageMap> {
    let failed = |fault: &dyn Display| error::of_text(format!("images: {fault}"));
    let mut table = csv::Writer::from_writer(Vec::new());
    let header = table.write_record(["sequence", "image"]);
    header.map_err(|fault| failed(&fault))?;
    for (sequence, image) in names {
        let row = table.write_record([&sequence.to_string(), image]);
        row.map_err(|fault| failed(&fault))?;
    }
    let bytes = table.into_inner().map_err(|fault| failed(&fault))?;
    ImageMap::read_from("images", bytes.as_slice()).map_err(|error| error::of_input(&error))
}
