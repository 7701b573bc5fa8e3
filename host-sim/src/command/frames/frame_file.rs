//! A file of frames, read with a progress bar.

use std::fs::File;
use std::io::BufRead;
use std::path::Path;

use fmc_camera_file::{InputError, text_file};

use crate::command::point_stream::progress;

/// Opens a file, hands its reader on, and shows how far it has been read: on a terminal, unless the
/// answers stand there at the same time.
///
/// # Errors
/// [`InputError`] if it cannot be opened or is no text; and those of `read`.
pub(in crate::command) fn with_bar<E: From<InputError>>(
    path: &Path,
    answers_elsewhere: bool,
    read: impl FnOnce(&str, &mut dyn BufRead) -> Result<(), E>,
) -> Result<(), E> {
    let file = File::open(path).map_err(|error| InputError::reading(path, &error))?;
    let bytes = file.metadata().ok().filter(std::fs::Metadata::is_file);
    let bar = progress(bytes.map(|metadata| metadata.len()), answers_elsewhere);
    let name = path.display().to_string();
    let source = text_file::of(&name, bar.wrap_read(file));
    let done = source
        .map_err(E::from)
        .and_then(|mut source| read(&name, &mut source));
    bar.finish_and_clear();
    done
}
