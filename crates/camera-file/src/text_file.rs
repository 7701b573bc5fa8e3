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
/// [`InputError`] for a file that cannot be read, and as [`of`].
pub fn open(path: &Path) -> Result<BufReader<File>, InputError> {
    let file = File::open(path).map_err(|error| InputError::reading(path, &error))?;
    of(&path.display().to_string(), file)
}

/// Reads from a source of text; `name` is the one that messages use for it.
///
/// # Errors
/// [`InputError`] for a source whose first bytes, at most 256 KiB, hold one of zero and no line
/// end: such a table would be read as a whole before anything is wrong with it.
pub fn of<R: Read>(name: &str, source: R) -> Result<BufReader<R>, InputError> {
    let mut reader = BufReader::with_capacity(BUFFER, source);
    let start = reader.fill_buf();
    let start = start.map_err(|error| InputError::reading(Path::new(name), &error))?;
    if start.contains(&0) && !start.contains(&b'\n') {
        return Err(InputError::invalid(format!(
            "{name}: not a text file: it holds bytes of zero"
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_without_a_line_end_are_no_text() {
        let refused = of("zeros", io::repeat(0)).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "zeros: not a text file: it holds bytes of zero"
        );
        // The reader of the table names what is wrong with a line.
        for bytes in ["", "a,b", "a\0b\n1,2\n"] {
            let mut read = String::new();
            let mut source = of("table", bytes.as_bytes()).unwrap();
            source.read_to_string(&mut read).unwrap();
            assert_eq!(read, bytes);
        }
    }
}
