//! One exposure, as Python's arguments describe it.

use fmc_camera::flight::exposure::{CorrectionModel, Exposure, FlightDirection};
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera_file::number::single;
use pyo3::prelude::*;

use crate::choice::choice;

/// Models of the correction, by their words.
const MODELS: [(&str, CorrectionModel); 3] = [
    ("exact", CorrectionModel::Exact),
    ("fitted", CorrectionModel::Fitted),
    ("static", CorrectionModel::Static),
];

/// Directions of flight.
const DIRECTIONS: [(&str, FlightDirection); 2] = [
    ("forward", FlightDirection::Forward),
    ("reverse", FlightDirection::Reverse),
];

/// Formulas of the focus shift.
const FOCUS_SIGNS: [(&str, FocusSign); 2] = [
    ("physical", FocusSign::Physical),
    ("printed", FocusSign::Printed),
];

/// Arguments of `Camera.frame`, in double precision as they were given.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ExposureArguments {
    pub(crate) vh_per_s: f64,
    pub(crate) exposure_s: f64,
    pub(crate) direction: FlightDirection,
    pub(crate) focus_shift_um: f64,
    pub(crate) opening_offset_mm: Option<f64>,
    pub(crate) focus_sign: FocusSign,
    pub(crate) model: CorrectionModel,
}

/// Arguments that are words.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Words<'a> {
    pub(crate) direction: &'a str,
    pub(crate) focus_sign: &'a str,
    pub(crate) model: &'a str,
}

impl Words<'_> {
    /// Returns direction, formula and model.
    ///
    /// # Errors
    /// `fmc_camera.Error` for another word.
    pub(crate) fn read(self) -> PyResult<(FlightDirection, FocusSign, CorrectionModel)> {
        Ok((
            choice("direction", self.direction, &DIRECTIONS)?,
            choice("focus_sign", self.focus_sign, &FOCUS_SIGNS)?,
            choice("model", self.model, &MODELS)?,
        ))
    }
}

impl ExposureArguments {
    /// Returns the exposure in the camera's precision.
    pub(crate) fn exposure(&self) -> Exposure {
        Exposure {
            vh_per_s: single(self.vh_per_s),
            exposure_s: single(self.exposure_s),
            opening_offset_mm: self.opening_offset_mm.map(single),
            focus_shift_um: single(self.focus_shift_um),
            focus_sign: self.focus_sign,
            model: self.model,
            direction: self.direction,
        }
    }

    /// Returns the words of the arguments.
    pub(crate) fn words(&self) -> Words<'static> {
        Words {
            direction: word(&DIRECTIONS, self.direction),
            focus_sign: word(&FOCUS_SIGNS, self.focus_sign),
            model: word(&MODELS, self.model),
        }
    }
}

fn word<T: Copy + PartialEq>(among: &'static [(&'static str, T)], value: T) -> &'static str {
    let found = among.iter().find(|(_, one)| *one == value);
    found.map_or("", |(word, _)| word)
}
