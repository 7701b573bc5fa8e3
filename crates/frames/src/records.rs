//! Records of a flight, `records.csv` and `records.json`, as a stream of frames.

mod json;
mod stream;
mod table;

use std::io::BufRead;
use std::path::Path;

use fmc_camera_file::{InputError, text_file};

use self::stream::Stream;
use crate::{FlightFrame, FrameCamera};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads records, and gives each frame to `each`, in the order of the file.
///
/// The file is not held in memory. Its first character tells JSON from CSV.
///
/// # Errors
/// [`InputError`] naming file, line or record, column, value and allowed range: records of another
/// calibration than the camera's, a number that is none or out of its range, an exposure without
/// an interior orientation, a sequence that comes twice, a column that is missing, half a file;
/// and the errors of `each`.
pub fn read<E: From<InputError>>(
    path: &Path,
    camera: &FrameCamera,
    each: impl FnMut(FlightFrame) -> Result<(), E>,
) -> Result<(), E> {
    let file = text_file::open(path)?;
    read_from(&path.display().to_string(), file, camera, each)
}

/// Reads records as [`read`] does, from any source; `file` is its name in messages.
///
/// # Errors
/// Those of [`read`].
pub fn read_from<E: From<InputError>>(
    file: &str,
    mut source: impl BufRead,
    camera: &FrameCamera,
    each: impl FnMut(FlightFrame) -> Result<(), E>,
) -> Result<(), E> {
    let stream = Stream::new(file, camera, each);
    let start = source
        .fill_buf()
        .map_err(|error| InputError::reading(file.as_ref(), &error))?;
    let has_mark = start.starts_with(BYTE_ORDER_MARK);
    if has_mark {
        source.consume(BYTE_ORDER_MARK.len());
    }
    let start = source
        .fill_buf()
        .map_err(|error| InputError::reading(file.as_ref(), &error))?;
    match start.iter().find(|byte| !byte.is_ascii_whitespace()) {
        None => Err(InputError::invalid(format!("{file}: the file is empty")).into()),
        Some(b'{' | b'[') => json::read(source, stream),
        Some(_) => table::read(source, stream),
    }
}
