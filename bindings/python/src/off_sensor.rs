//! Points that are not on the sensor.

use pyo3::prelude::*;

use crate::choice::choice;

/// Answer to a point that is off the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OffSensor {
    /// The polynomial continued, as the library in Rust and in C does; of a point to be distorted,
    /// whose measured place must be on the sensor, NaN.
    Extrapolate,
    /// NaN in both coordinates.
    Nan,
    /// An error, before anything is written.
    Error,
}

impl OffSensor {
    /// Returns the answer of an argument.
    ///
    /// # Errors
    /// `fmc_camera.Error` for another word.
    pub(crate) fn of(word: &str) -> PyResult<Self> {
        choice(
            "off_sensor",
            word,
            &[
                ("extrapolate", Self::Extrapolate),
                ("nan", Self::Nan),
                ("error", Self::Error),
            ],
        )
    }
}
