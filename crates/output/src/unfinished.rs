//! Files that are written whole, and have no name yet.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use crate::part::Part;

/// Writes a file that has no name yet, or a device or a pipe, which is then complete: `None`.
///
/// A symbolic link stays one; its target is replaced once the file is complete. A file that may not
/// be written is not replaced.
///
/// # Errors
/// Those of the file system and of `body`.
pub fn write<E: From<io::Error>>(
    path: &Path,
    body: impl FnOnce(&mut dyn io::Write) -> Result<(), E>,
) -> Result<Option<Part>, E> {
    let path = match fs::metadata(path) {
        // A pipe or a device is written in place: renaming would replace it.
        Ok(existing) if !existing.is_file() && !existing.is_dir() => {
            let mut file = BufWriter::new(File::options().write(true).open(path)?);
            body(&mut file)?;
            file.flush()?;
            return Ok(None);
        }
        Ok(existing) if existing.is_dir() => {
            return Err(io::Error::from(io::ErrorKind::IsADirectory).into());
        }
        Ok(existing) if existing.permissions().readonly() => {
            return Err(io::Error::from(io::ErrorKind::PermissionDenied).into());
        }
        // A symbolic link stays one, whether its target exists or not.
        Ok(_) => fs::canonicalize(path)?,
        Err(_) => match fs::read_link(path) {
            Ok(target) => path.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => path.to_path_buf(),
        },
    };
    let part = Part::create(path)?;
    let mut file = BufWriter::new(part);
    body(&mut file)?;
    let part = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    Ok(Some(part))
}
