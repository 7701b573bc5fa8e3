//! Columns of a table and the values in them.

use csv::StringRecord;
use fmc_camera_file::InputError;
use fmc_camera_file::number::clipped;

/// Returns the error of a table that cannot be read further.
pub(crate) fn csv_error(
    file: &str,
    names: &[String],
    row: &StringRecord,
    error: &csv::Error,
) -> InputError {
    let line = error.position().map_or(0, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::Io(error) => InputError::reading(file.as_ref(), error),
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => InputError::invalid(format!(
            "{file}, line {line}: {len} columns where the header has {expected_len}"
        )),
        csv::ErrorKind::Deserialize { err, .. } => {
            let place = err.field().and_then(|field| usize::try_from(field).ok());
            let found = place.and_then(|place| Some((names.get(place)?, row.get(place)?)));
            InputError::invalid(match found {
                Some((name, value)) => {
                    format!(
                        "{file}, line {line}: {name} = \"{}\": {}",
                        shown(value),
                        err.kind()
                    )
                }
                None => format!("{file}, line {line}: {}", err.kind()),
            })
        }
        csv::ErrorKind::Utf8 { .. } => {
            InputError::invalid(format!("{file}, line {line}: not text (UTF-8)"))
        }
        _ => InputError::invalid(format!("{file}: {error}")),
    }
}

/// Returns the names of the columns, without spaces around them.
///
/// # Errors
/// [`InputError`] for an empty file, and for a name that stands twice.
pub(crate) fn names(file: &str, header: &StringRecord) -> Result<Vec<String>, InputError> {
    let names: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
    if names.iter().all(String::is_empty) {
        return Err(InputError::invalid(format!("{file}: the file is empty")));
    }
    let mut sorted: Vec<&String> = names.iter().collect();
    sorted.sort_unstable();
    for (name, next) in sorted.iter().zip(sorted.iter().skip(1)) {
        if name == next {
            return Err(InputError::invalid(format!(
                "{file}, line 1: column {} appears twice",
                shown(name)
            )));
        }
    }
    Ok(names)
}

/// Returns as much of a text as a message can show, on one line.
pub(crate) fn shown(text: &str) -> String {
    clipped(text).escape_debug().to_string()
}

/// Checks that a row has as many cells as the header; the reader's own error of it has the line of
/// the reader.
///
/// # Errors
/// [`InputError`] naming the line.
pub(crate) fn check_length(
    file: &str,
    line: u64,
    row: &StringRecord,
    names: &[String],
) -> Result<(), InputError> {
    if row.len() == names.len() {
        return Ok(());
    }
    Err(InputError::invalid(format!(
        "{file}, line {line}: {} columns where the header has {}",
        row.len(),
        names.len()
    )))
}
