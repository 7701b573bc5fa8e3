//! Reasons why a calibration has no result.

use fmc_camera_file::InputError;

use super::least_squares::{AdjustmentError, MOST_ITERATIONS};

/// A reason why a calibration has no result.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationFailure {
    /// The observations cannot give one.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The adjustment did not converge.
    #[error(
        "{file}: the adjustment has not converged after {MOST_ITERATIONS} iterations: the last still moved a residual by {step_mm:.1e} mm"
    )]
    NotConverged {
        /// File of the observations.
        file: String,
        /// Largest change of a residual in the last iteration, mm.
        step_mm: f64,
    },
}

/// Returns the failure of an adjustment; `name` names its unknowns and `place` its observations.
pub(crate) fn failure(
    file: &str,
    error: &AdjustmentError,
    name: impl Fn(usize) -> String,
    place: impl Fn(usize) -> String,
) -> CalibrationFailure {
    match error {
        AdjustmentError::TooFew {
            components,
            unknowns,
        } => InputError::invalid(format!(
            "{file}: {components} observations do not suffice for {unknowns} unknowns"
        ))
        .into(),
        AdjustmentError::Undefined { index } => InputError::invalid(format!(
            "{file}: {} lies behind the camera that the others determine",
            place(*index)
        ))
        .into(),
        AdjustmentError::Inseparable { unknowns } => {
            let names: Vec<String> = unknowns.iter().map(|index| name(*index)).collect();
            InputError::invalid(format!(
                "{file}: the observations cannot tell {} apart",
                listed(&names)
            ))
            .into()
        }
        AdjustmentError::NotConverged { step_mm } => CalibrationFailure::NotConverged {
            file: file.to_owned(),
            step_mm: *step_mm,
        },
    }
}

/// Writes names as a list in a sentence.
#[must_use]
pub fn listed(names: &[String]) -> String {
    match names.split_last() {
        None => "the unknowns".to_owned(),
        Some((last, [])) => format!("{last} and the other unknowns"),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}
