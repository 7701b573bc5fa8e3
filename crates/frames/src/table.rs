//! Table of exposures, a row each, for frames without records.

mod exposure;
mod heading;

use std::io::Read;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use fmc_camera_file::{InputError, text_file};

pub use self::exposure::GivenExposure;
use self::heading::Heading;
use crate::columns::{check_length, csv_error, names};
use crate::sequences::Sequences;
use crate::{FlightFrame, FrameCamera, Lines, Outcome};

/// Reads a table of exposures, and gives each frame to `each`, in the order of the file.
///
/// Columns, in any order, by the names of `host-sim frame`'s options with or without their units:
///
/// | columns | meaning |
/// |---|---|
/// | `sequence`, `frame`, `image` | at least one names the exposure; a `frame` that is no number is the name of its image |
/// | `vh`, or `ground_speed` (m/s) and `height` (m) | V/H, 1/s |
/// | `exposure` | exposure time, s, or a fraction such as 1/200 |
/// | `opening_offset_mm`, `focus_shift_um`, `direction`, `focus_sign`, `model` | as the options |
/// | `centroid_us`, `centroid_unix_us`, `utc_sigma_s`, `principal_point_frame_sigma_mm`, `principal_point_common_sigma_mm` | as in `records.csv` |
///
/// A column that is missing, or a cell that is empty, has the value of `given`.
///
/// # Errors
/// [`InputError`] naming file, line, column, value and allowed range: an exposure that the camera
/// refuses, a sequence that comes twice, a column that is not known; and the errors of `each`.
pub fn read<E: From<InputError>>(
    path: &Path,
    camera: &FrameCamera,
    given: &GivenExposure,
    each: impl FnMut(FlightFrame) -> Result<(), E>,
) -> Result<(), E> {
    let file = text_file::open(path)?;
    read_from(&path.display().to_string(), file, camera, given, each)
}

/// Reads a table as [`read`] does, from any source; `file` is its name in messages.
///
/// # Errors
/// Those of [`read`].
pub fn read_from<E: From<InputError>>(
    file: &str,
    source: impl Read,
    camera: &FrameCamera,
    given: &GivenExposure,
    mut each: impl FnMut(FlightFrame) -> Result<(), E>,
) -> Result<(), E> {
    let mut reader = ReaderBuilder::new()
        .flexible(true)
        .trim(Trim::All)
        .from_reader(source);
    let mut row = StringRecord::new();
    let header = reader.headers();
    let header = header.map_err(|error| csv_error(file, &[], &row, &error))?;
    let names = names(file, header)?;
    let heading = Heading::find(file, &names)?;
    let mut sequences = Sequences::default();
    let (mut count, mut lines) = (0, Lines::default());
    while reader
        .read_record(&mut row)
        .map_err(|error| csv_error(file, &names, &StringRecord::new(), &error))?
    {
        count += 1;
        let line = lines.of(row.position());
        check_length(file, line, &row, &names)?;
        let cells = heading.row(file, line, &row);
        let (sequence, image) = cells.name(count)?;
        if !sequences.insert(sequence) {
            return Err(cells
                .refused(&format!("sequence {sequence} appears twice"))
                .into());
        }
        each(FlightFrame {
            sequence,
            image,
            trigger: None,
            outcome: Outcome::Exposed(given.exposed(&cells, camera)?),
            faults: String::new(),
            flags: String::new(),
            calibration_crc: None,
        })?;
    }
    if count == 0 {
        return Err(InputError::invalid(format!("{file}: it holds no exposures")).into());
    }
    Ok(())
}
