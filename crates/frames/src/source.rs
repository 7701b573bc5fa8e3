//! Frames of a source that holds either records or a table of exposures.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use fmc_camera_file::InputError;

use crate::table::{self, GivenExposure};
use crate::{FlightFrame, FrameCamera, records};

/// Columns that records have, and tables of exposures have not.
const OF_RECORDS: [&str; 3] = ["trigger_us", "outcome", "calibration_crc32"];

/// Reads the frames of a file, one after the other.
///
/// # Errors
/// [`InputError`] naming the file, and the line that cannot be used; that of `each` ends it.
pub fn read(
    path: &Path,
    camera: &FrameCamera,
    each: &mut dyn FnMut(FlightFrame) -> Result<(), InputError>,
) -> Result<(), InputError> {
    let file = File::open(path).map_err(|error| InputError::reading(path, &error))?;
    let source = BufReader::with_capacity(1 << 18, file);
    read_from(&path.display().to_string(), source, camera, each)
}

/// Reads frames from a source of that name in messages: records in JSON, or in a table with one of
/// the columns `trigger_us`, `outcome` and `calibration_crc32`; or else a table of exposures.
///
/// # Errors
/// As [`read`].
pub fn read_from(
    name: &str,
    mut source: impl BufRead,
    camera: &FrameCamera,
    each: &mut dyn FnMut(FlightFrame) -> Result<(), InputError>,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_told_from_tables_of_exposures_by_their_start() {
        for records in [
            "[{\"sequence\": 1}]",
            "\u{feff}sequence,\"outcome\"\r\n1,exposed\r\n",
            "",
        ] {
            assert!(are_records(records.as_bytes()), "{records:?}");
        }
        assert!(!are_records(
            b"sequence,vh_per_s,exposure_s\n1,0.17,0.005\n"
        ));
    }
}
