//! Reason for a refusal, as it goes from call to call inside the library.

use fmc::flight::camera::FrameError;
use fmc::flight::controller::ControllerError;
use fmc::geometry::calibration::{CalibrationError, Polynomial};
use fmc::geometry::inverse::{DistortError, MAX_STEPS};
use fmc::geometry::invertibility::MIN_SCALE;
use fmc::geometry::range::OutOfRange;

use crate::error::{
    FMC_ERROR_FITTED_FOLDS, FMC_ERROR_FOLDS, FMC_ERROR_NOT_CONVERGED, FMC_ERROR_NOT_FITTED,
    FMC_ERROR_OFF_SENSOR, FMC_ERROR_OUT_OF_RANGE, FMC_ERROR_SPEED, FMC_ERROR_STROKE,
    FMC_ERROR_TIME, FMC_OK, fmc_error, fmc_status,
};

/// Reason for a refusal.
///
/// It becomes a [`fmc_error`] once, where a call ends: that one is twice as large, and to hand it
/// on from function to function was a twentieth of a small program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// An argument, a code or bytes.
    Failure(Failure),
    /// A quantity.
    Range(OutOfRange),
    /// A calibration.
    Calibration(CalibrationError),
    /// An exposure.
    Frame(FrameError),
    /// A point.
    Point {
        /// Reason.
        error: DistortError,
        /// Its index.
        index: u32,
    },
}

/// What is wrong with an argument, a code or bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Failure {
    status: fmc_status,
    argument: u32,
    index: u32,
    numbers: [u32; 2],
}

impl Failure {
    /// Returns a failure with a status and without details.
    pub(crate) const fn new(status: fmc_status) -> Self {
        Self {
            status,
            argument: 0,
            index: 0,
            numbers: [0; 2],
        }
    }

    /// Returns a failure about an argument, from 1.
    pub(crate) const fn of_argument(status: fmc_status, argument: u32) -> Self {
        Self {
            argument,
            ..Self::new(status)
        }
    }

    /// Adds what was found and what was expected.
    pub(crate) const fn numbers(self, number: u32, expected: u32) -> Self {
        Self {
            numbers: [number, expected],
            ..self
        }
    }

    /// Adds an index.
    pub(crate) const fn at(self, index: u32) -> Self {
        Self { index, ..self }
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl From<OutOfRange> for Refusal {
    fn from(error: OutOfRange) -> Self {
        Self::Range(error)
    }
}

impl From<CalibrationError> for Refusal {
    fn from(error: CalibrationError) -> Self {
        Self::Calibration(error)
    }
}

impl From<FrameError> for Refusal {
    fn from(error: FrameError) -> Self {
        Self::Frame(error)
    }
}

impl From<ControllerError> for Refusal {
    fn from(error: ControllerError) -> Self {
        match error {
            ControllerError::Settings(error) => error.into(),
            ControllerError::Travel(error) => error.into(),
        }
    }
}

/// Returns the refusal of the point with an index.
#[cold]
pub(crate) fn of_point(error: DistortError, index: usize) -> Refusal {
    let index = u32::try_from(index).unwrap_or(u32::MAX);
    Refusal::Point { error, index }
}

impl From<Refusal> for fmc_error {
    #[cold]
    #[inline(never)]
    fn from(refusal: Refusal) -> Self {
        let mut error = Self::of_status(FMC_OK);
        error.status = match refusal {
            Refusal::Failure(failure) => {
                error.index = failure.index;
                error.argument = failure.argument;
                [error.number, error.expected] = failure.numbers;
                failure.status
            }
            Refusal::Range(range)
            | Refusal::Calibration(CalibrationError::OutOfRange(range))
            | Refusal::Frame(FrameError::OutOfRange(range)) => {
                error.quantity = range.quantity as i32;
                error.value = range.value;
                [error.least, error.most] = [range.min, range.max];
                FMC_ERROR_OUT_OF_RANGE
            }
            Refusal::Calibration(CalibrationError::Folds {
                polynomial,
                scale,
                at,
            }) => {
                [error.value, error.least] = [scale, MIN_SCALE];
                [error.x_mm, error.y_mm] = [at.x_mm, at.y_mm];
                match polynomial {
                    Polynomial::Static => FMC_ERROR_FOLDS,
                    Polynomial::Fitted => FMC_ERROR_FITTED_FOLDS,
                }
            }
            Refusal::Frame(FrameError::Stroke(stroke)) => {
                [error.value, error.other] = [stroke.from_mm, stroke.to_mm];
                error.most = stroke.half_stroke_mm;
                FMC_ERROR_STROKE
            }
            Refusal::Frame(FrameError::NotFitted) => FMC_ERROR_NOT_FITTED,
            Refusal::Frame(FrameError::Speed {
                wanted_mm_s,
                max_mm_s,
            }) => {
                error.value = wanted_mm_s;
                [error.least, error.most] = [-max_mm_s, max_mm_s];
                FMC_ERROR_SPEED
            }
            Refusal::Frame(FrameError::Time {
                needed_s,
                available_s,
            }) => {
                [error.value, error.most] = [needed_s, available_s];
                FMC_ERROR_TIME
            }
            Refusal::Point {
                error: refused,
                index,
            } => {
                error.index = index;
                match refused {
                    DistortError::OffSensor(point) => {
                        [error.x_mm, error.y_mm] = [point.x_mm, point.y_mm];
                        FMC_ERROR_OFF_SENSOR
                    }
                    DistortError::NotConverged { residual_nm } => {
                        error.value = residual_nm;
                        [error.number, error.expected] = [MAX_STEPS.into(); 2];
                        FMC_ERROR_NOT_CONVERGED
                    }
                }
            }
        };
        error
    }
}
