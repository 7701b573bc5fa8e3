//! Records of a flight, or a table of exposures, from files and from tables in memory.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use fmc_camera_file::InputError;
use fmc_frames::table::{self, GivenExposure};
use fmc_frames::{FlightFrame, FrameCamera, FrameTable, records};
use pyo3::prelude::*;

use crate::camera::CameraParts;
use crate::error;
use crate::table_cells::TableCells;

/// Columns that records have, and tables of exposures have not.
const OF_RECORDS: [&str; 3] = ["trigger_us", "outcome", "calibration_crc32"];

/// Name of a table in memory, in messages.
const IN_MEMORY: &str = "records";

type Each<'a> = &'a mut dyn FnMut(FlightFrame) -> Result<(), InputError>;

/// Reads frames, and returns them with their name in messages.
///
/// # Errors
/// `fmc_camera.InvalidFile`.
pub(crate) fn read(
    camera: &CameraParts,
    records: &Bound<'_, PyAny>,
    images: Option<&Bound<'_, PyAny>>,
) -> PyResult<(FrameTable, String)> {
    let mut images: HashMap<u32, String> = match images {
        None => HashMap::new(),
        Some(images) => images.extract()?,
    };
    let file = records.extract::<PathBuf>().ok();
    let bytes = match &file {
        Some(_) => Vec::new(),
        None => TableCells::of(records)?.csv()?,
    };
    let name = file
        .as_ref()
        .map_or_else(|| IN_MEMORY.to_owned(), |path| path.display().to_string());
    let table = records.py().detach(|| {
        FrameTable::collect(|each| {
            let mut named = |mut frame: FlightFrame| {
                if let Some(image) = images.remove(&frame.sequence) {
                    frame.image = Some(image);
                }
                each(frame)
            };
            match &file {
                Some(path) => read_file(path, &camera.camera, &mut named),
                None => read_from(&name, bytes.as_slice(), &camera.camera, &mut named),
            }
        })
    });
    let table = table.map_err(|error| error::of_input(&error))?;
    if let Some(sequence) = images.keys().min() {
        return Err(error::of_no_frame(
            format!("images: sequence {sequence} is not in {name}"),
            &sequence.to_string(),
        ));
    }
    Ok((table, name))
}

fn read_file(path: &Path, camera: &FrameCamera, each: Each<'_>) -> Result<(), InputError> {
    let file = File::open(path).map_err(|error| InputError::reading(path, &error))?;
    let source = BufReader::with_capacity(1 << 18, file);
    read_from(&path.display().to_string(), source, camera, each)
}

fn read_from(
    name: &str,
    mut source: impl BufRead,
    camera: &FrameCamera,
    each: Each<'_>,
) -> Result<(), InputError> {
    let start = source
        .fill_buf()
        .map_err(|error| InputError::reading(name.as_ref(), &error))?;
    if are_records(start) {
        records::read_from(name, source, camera, each)
    } else {
        table::read_from(name, source, camera, &GivenExposure::default(), each)
    }
}

/// Returns true for the start of records: JSON, or the header of their table.
fn are_records(start: &[u8]) -> bool {
    let text = String::from_utf8_lossy(start);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    let header = text.lines().next().unwrap_or_default();
    let mut names = header.split(',').map(|name| name.trim().trim_matches('"'));
    header.is_empty()
        || header.starts_with(['{', '['])
        || names.any(|name| OF_RECORDS.contains(&name))
}
