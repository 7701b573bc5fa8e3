//! Insertion of residual grids into the text of a camera file; the rest stays as it is.

use std::str::FromStr;

use fmc_camera::geometry::grid::GridCarrier;
use toml_edit::{DocumentMut, Value};

use crate::grid_files::GridFiles;
use crate::input_error::InputError;
use crate::insertion::{put, table};

/// File of a residual grid, as `[grid]` names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridEntry {
    /// Key of the part: `lens` or `sensor`.
    pub key: &'static str,
    /// Name, relative to the camera file.
    pub file: String,
    /// CRC-32 with which the file ends.
    pub crc32: u32,
}

/// Names and bytes of files.
pub type NamedFiles = Vec<(String, Vec<u8>)>;

/// Returns the name that the file of a part's grid has beside its camera file.
#[must_use]
pub const fn file_name(carrier: GridCarrier) -> &'static str {
    match carrier {
        GridCarrier::Lens => "grid-lens.fmcg",
        GridCarrier::Sensor => "grid-sensor.fmcg",
    }
}

/// Returns the text of a camera file whose `[grid]` names these files and no others; `file` is the
/// name that messages use.
///
/// # Errors
/// [`InputError`] for a text that is not TOML, or in which `grid` is no table.
pub fn with_grids(file: &str, text: &str, entries: &[GridEntry]) -> Result<String, InputError> {
    let text = without_grids(file, text)?;
    let mut document = document(file, &text)?;
    if entries.is_empty() {
        return Ok(text);
    }
    let block = table(&mut document, "grid")
        .ok_or_else(|| InputError::invalid(format!("{file}: grid is no table")))?;
    for entry in entries {
        put(block, entry.key, Value::from(entry.file.as_str()));
        let crc32 = format!("{:08x}", entry.crc32);
        put(block, &format!("{}_crc32", entry.key), Value::from(crc32));
    }
    Ok(document.to_string())
}

/// Returns the text of a camera file whose `[grid]` names copies of these grids beside it, and the
/// copies with their names.
///
/// # Errors
/// As [`with_grids`].
pub fn with_copies(
    file: &str,
    text: &str,
    grids: &GridFiles,
) -> Result<(String, NamedFiles), InputError> {
    let (mut entries, mut copies) = (Vec::new(), Vec::new());
    for (carrier, key) in [(GridCarrier::Lens, "lens"), (GridCarrier::Sensor, "sensor")] {
        let Some(bytes) = grids.bytes(carrier) else {
            continue;
        };
        let name = file_name(carrier).to_owned();
        let crc32 = bytes.last_chunk().map_or(0, |crc| u32::from_le_bytes(*crc));
        copies.push((name.clone(), bytes.to_vec()));
        entries.push(GridEntry {
            key,
            file: name,
            crc32,
        });
    }
    Ok((with_grids(file, text, &entries)?, copies))
}

/// Returns the text of a camera file without `[grid]`.
///
/// # Errors
/// [`InputError`] for a text that is not TOML.
pub fn without_grids(file: &str, text: &str) -> Result<String, InputError> {
    let mut document = document(file, text)?;
    document.remove("grid");
    Ok(document.to_string())
}

fn document(file: &str, text: &str) -> Result<DocumentMut, InputError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    DocumentMut::from_str(text).map_err(|error| InputError::invalid(format!("{file}: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str = "name = \"A\" # owner: B\n\n[grid]\nlens = \"old.fmcg\"\nlens_crc32 = \"00000001\"\n\n[sensor]\nwidth_px = 1\n";

    #[test]
    fn grids_replace_those_of_the_file() {
        let entry = GridEntry {
            key: "sensor",
            file: "new.fmcg".to_owned(),
            crc32: 0xab,
        };
        let text = with_grids("a.toml", CAMERA, &[entry]).unwrap();
        assert_eq!(
            text,
            "name = \"A\" # owner: B\n\n[sensor]\nwidth_px = 1\n\n[grid]\nsensor = \"new.fmcg\"\nsensor_crc32 = \"000000ab\"\n"
        );
        assert_eq!(
            without_grids("a.toml", &text).unwrap(),
            "name = \"A\" # owner: B\n\n[sensor]\nwidth_px = 1\n"
        );
        let error = with_grids("a.toml", "name = ", &[]).unwrap_err();
        assert!(error.to_string().starts_with("a.toml: "), "{error}");
    }
}
