//! Coordinates with which points are answered.

use fmc_points::Answer;
use pyo3::prelude::*;

use crate::choice::choice;

/// Returns the coordinates of an argument.
///
/// # Errors
/// `fmc_camera.Error` for another word.
pub(crate) fn answer(word: &str) -> PyResult<Answer> {
    choice(
        "answer",
        word,
        &[
            ("ideal", Answer::Ideal),
            ("ideal-shifted", Answer::IdealShifted),
            ("measured-shifted", Answer::MeasuredShifted),
        ],
    )
}
