//! Arguments that are one of a few words.

use pyo3::prelude::*;

use crate::error;

/// Returns the value of a word.
///
/// # Errors
/// `fmc_camera.Error` naming the argument and its words.
pub(crate) fn choice<T: Copy>(argument: &str, word: &str, among: &[(&str, T)]) -> PyResult<T> {
    let found = among.iter().find(|(one, _)| *one == word);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let words: Vec<String> = among.iter().map(|(one, _)| format!("'{one}'")).collect();
        error::of_text(format!(
            "{argument} = '{word}': must be {}",
            words.join(" or ")
        ))
    })
}
