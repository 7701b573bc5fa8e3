//! Coordinates with which points are answered.

use pyo3::prelude::*;

use crate::choice::choice;

/// Coordinates of an answer, as `docs/formats.md` has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Ideal points about the principal point of their frame.
    Ideal,
    /// Ideal points about the calibrated principal point.
    IdealShifted,
    /// Measured points about the calibrated principal point, with their distortion.
    MeasuredShifted,
}

impl Answer {
    /// Returns the answer of an argument.
    ///
    /// # Errors
    /// `fmc_camera.Error` for another word.
    pub(crate) fn of(word: &str) -> PyResult<Self> {
        choice(
            "answer",
            word,
            &[
                ("ideal", Self::Ideal),
                ("ideal-shifted", Self::IdealShifted),
                ("measured-shifted", Self::MeasuredShifted),
            ],
        )
    }
}
