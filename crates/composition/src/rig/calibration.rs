//! Calibration of a rig: polynomials of all sub-images from control and ties, with the orientations
//! of the exposures.

use fmc_camera_file::InputError;

use super::control::Measurements;
use super::description::{Heights, Rig};
use super::gauge::{Movement, functionals};
use super::start::{Start, start};

mod outcome;
mod quality;
mod refusal;
mod system;

pub use outcome::{
    Correlation, MovementEstimate, RigCalibration, RigOptions, RigResidual, SubQuality,
};
use quality::result;
use refusal::check_counts;
use system::{HELD_PX, System};

/// Calibrates a rig.
///
/// # Model
/// `P_s(ξ, η) = (u, v)` of control projected with its height by the orientation of its exposure;
/// `P_a = P_b` of a tie, since all sub-images have one projection centre. Both are linear in the
/// coefficients; the orientations are linearised. The mean place, the turn and, where the data do
/// not tell them, the scale and the keystone of all sub-images together stay nominal: what is left
/// of them goes into the orientations. With [`Heights::Ignore`] (Zhao et al. 2013) `(u, v)` are X
/// and Y of the ground by a similarity, and no orientation is estimated.
///
/// # Errors
/// [`InputError`] naming the point, the sub-image or the exposure: what
/// [`Measurements::check`] refuses, too few points for the coefficients, or places not determined.
pub fn calibrate(
    rig: &Rig,
    measurements: &Measurements,
    options: &RigOptions,
) -> Result<RigCalibration, InputError> {
    measurements.check(rig)?;
    let exposures = measurements.exposures();
    if options.heights == Heights::Ignore && exposures.len() > 1 {
        return Err(InputError::invalid(format!(
            "{}: exposures {}: without heights the polynomials are those of one exposure; choose one",
            measurements.control_file,
            exposures.join(", ")
        )));
    }
    check_counts(rig, measurements, options.degree)?;
    let starts: Vec<Start> = exposures
        .iter()
        .map(|name| start(rig, measurements, name))
        .collect::<Result<_, _>>()?;
    let mut system = System {
        rig,
        measurements,
        options,
        exposures: &exposures,
        starts: &starts,
        functionals: match options.heights {
            Heights::Use => functionals(rig, options.degree),
            Heights::Ignore => Vec::new(),
        },
        movement_sigmas: vec![HELD_PX; Movement::ALL.len()],
        accepted: vec![true; measurements.control.len() + measurements.ties.len()],
    };
    let movements = system.separate()?;
    let state = system.without_gross_errors()?;
    result(&system, &state, movements)
}
