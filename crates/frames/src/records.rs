//! Records of a flight, `records.csv` and `records.json`, as a stream of frames.

mod json;
mod table;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use fmc_camera_file::InputError;

use crate::check;
use crate::row::{Names, Row};
use crate::sequences::Sequences;
use crate::{Frame, FrameCamera};

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
    each: impl FnMut(Frame) -> Result<(), E>,
) -> Result<(), E> {
    let file = File::open(path).map_err(|error| InputError::reading(path, &error))?;
    read_from(
        &path.display().to_string(),
        BufReader::with_capacity(1 << 18, file),
        camera,
        each,
    )
}

/// Reads records as [`read`] does, from any source; `file` is its name in messages.
///
/// # Errors
/// Those of [`read`].
pub fn read_from<E: From<InputError>>(
    file: &str,
    mut source: impl BufRead,
    camera: &FrameCamera,
    each: impl FnMut(Frame) -> Result<(), E>,
) -> Result<(), E> {
    let stream = Stream {
        file,
        camera,
        sequences: Sequences::default(),
        count: 0,
        each,
    };
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

/// Records on their way from a file to their user.
struct Stream<'a, F> {
    /// Name of the file in messages.
    file: &'a str,
    camera: &'a FrameCamera,
    sequences: Sequences,
    /// Number of records so far.
    count: u64,
    each: F,
}

impl<F> Stream<'_, F> {
    /// Checks a record and hands its frame on; `place` names it in messages.
    fn push<L: Names, E: From<InputError>>(&mut self, row: Row<L>, place: &str) -> Result<(), E>
    where
        F: FnMut(Frame) -> Result<(), E>,
    {
        self.count += 1;
        let frame = check::frame(row, place, self.camera)?;
        if !self.sequences.insert(frame.sequence) {
            let text = format!("{place}: sequence {} appears twice", frame.sequence);
            return Err(InputError::invalid(text).into());
        }
        (self.each)(frame)
    }

    /// Checks that there were records.
    fn end<E: From<InputError>>(&self) -> Result<(), E> {
        if self.count == 0 {
            return Err(InputError::invalid(format!("{}: it holds no records", self.file)).into());
        }
        Ok(())
    }
}
