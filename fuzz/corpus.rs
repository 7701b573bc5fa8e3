//! Corpora of the fuzz targets, as the targets' runs and the tests read them.

use std::fs;
use std::path::Path;

/// Longest input, bytes: a larger one is none that somebody wanted to keep.
const LONGEST_BYTES: usize = 1 << 16;

/// An input of a target.
#[derive(Debug)]
#[allow(dead_code, reason = "not every reader uses both")]
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
}

/// Reads the inputs of a corpus, in the order of their names.
///
/// # Errors
/// A text that names the folder or the file: it cannot be read, is empty, is no file, or is longer
/// than 64 KiB. A damaged corpus checks less than it says.
pub(crate) fn read(folder: &Path) -> Result<Vec<Input>, String> {
    let told = |path: &Path, what: &str| format!("corpus {}: {what}", path.display());
    let failed = |path: &Path, error: std::io::Error| told(path, &error.to_string());
    let mut inputs = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| failed(folder, error))? {
        let path = entry.map_err(|error| failed(folder, error))?.path();
        if !path.is_file() {
            return Err(told(&path, "not a file"));
        }
        let bytes = fs::read(&path).map_err(|error| failed(&path, error))?;
        if bytes.is_empty() {
            return Err(told(&path, "empty"));
        }
        if bytes.len() > LONGEST_BYTES {
            return Err(told(&path, "longer than 64 KiB"));
        }
        let name = path.file_name().unwrap_or_default();
        inputs.push(Input {
            name: name.to_string_lossy().into_owned(),
            bytes,
        });
    }
    if inputs.is_empty() {
        return Err(told(folder, "no input"));
    }
    inputs.sort_by(|one, other| one.name.cmp(&other.name));
    Ok(inputs)
}
