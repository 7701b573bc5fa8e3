//! Records of a flight, or a table of exposures, from files and from tables in memory.

use std::collections::HashMap;
use std::path::PathBuf;

use fmc_frames::{FlightFrame, FrameTable, source};
use pyo3::prelude::*;

use crate::camera::CameraParts;
use crate::error;
use crate::table_cells::TableCells;

/// Name of a table in memory, in messages.
const IN_MEMORY: &str = "records";

/// A file, or a table in memory, that is not read yet.
pub(crate) enum RecordSource {
    /// Path of a file.
    File(PathBuf),
    /// Table in memory, as a file of CSV has it.
    Table(Vec<u8>),
}

impl RecordSource {
    /// Takes the path of a file or a table.
    ///
    /// # Errors
    /// `fmc_camera.Error` for what is neither.
    pub(crate) fn of(records: &Bound<'_, PyAny>) -> PyResult<Self> {
        match records.extract::<PathBuf>() {
            Ok(path) => Ok(Self::File(path)),
            Err(_) => Ok(Self::Table(TableCells::of(records)?.csv()?)),
        }
    }

    /// Returns the name in messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Table(_) => IN_MEMORY.to_owned(),
        }
    }
}

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
    let given = RecordSource::of(records)?;
    let name = given.name();
    let table = records.py().detach(|| {
        FrameTable::collect(|each| {
            let mut named = |mut frame: FlightFrame| {
                if let Some(image) = images.remove(&frame.sequence) {
                    frame.image = Some(image);
                }
                each(frame)
            };
            let camera = &camera.camera;
            match &given {
                RecordSource::File(path) => source::read(path, camera, &mut named),
                RecordSource::Table(bytes) => {
                    source::read_from(&name, bytes.as_slice(), camera, &mut named)
                }
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
