//! Text files, told from others before they are read.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use crate::InputError;

/// Bytes that are looked at, and read at a time.
const BUFFER: usize = 1 << 18;

/// Largest camera file, bytes; those of the published cameras have less than 2 kB.
const MOST_BYTES: u64 = 1 << 20;

/// Opens a text file of any size.
///
/// # Errors
/// [`InputError`] for a file that cannot be read, or whose first 256 KiB hold a byte of zero: a
/// table without line ends would be read as a whole before anything is wrong with it.
pub fn open(path: &Path) -> Result<BufReader<File>, InputError> {
    let unreadable = |error: &io::Error| InputError::reading(path, error);
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    let mut reader = BufReader::with_capacity(BUFFER, file);
    let start = reader.fill_buf().map_err(|error| unreadable(&error))?;
    if start.contains(&0) {
        return Err(InputError::invalid(format!(
            "{}: not a text file: it holds bytes of zero",
            path.display()
        )));
    }
    Ok(reader)
}

/// Reads the text of a camera file.
pub(crate) fn read(path: &Path) -> Result<String, InputError> {
    let unreadable = |error: io::Error| match error.kind() {
        io::ErrorKind::InvalidData => {
            InputError::invalid(format!("{}: not a text file (UTF-8)", path.display()))
        }
        _ => InputError::reading(path, &error),
    };
    let mut text = String::new();
    let file = File::open(path).map_err(unreadable)?;
    let mut start = file.take(MOST_BYTES + 1);
    start.read_to_string(&mut text).map_err(unreadable)?;
    if start.limit() == 0 {
        return Err(InputError::invalid(format!(
            "{}: larger than {} MiB, which no camera file is",
            path.display(),
            MOST_BYTES >> 20
        )));
    }
    Ok(text)
}
