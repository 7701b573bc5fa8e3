//! Points that are not on the sensor.

use fmc_points::OffSensor;
use pyo3::prelude::*;

use crate::choice::choice;

/// Returns the answer to points off the sensor of an argument.
///
/// # Errors
/// `fmc_camera.Error` for another word.
pub(crate) fn off_sensor(word: &str) -> PyResult<OffSensor> {
    choice(
        "off_sensor",
        word,
        &[
            ("extrapolate", OffSensor::Extrapolate),
            ("nan", OffSensor::Nan),
            ("error", OffSensor::Error),
        ],
    )
}
