//! Outcome of one observed repetition, adjusted with one model.

use fmc_adjustment::adjustment::{Adjusted, Adjustment, AdjustmentError};
use fmc_adjustment::correction::COEFFICIENTS;
use fmc_adjustment::exterior_orientation::ELEMENTS;
use fmc_adjustment::frame_observation::{ControlObservation, FrameObservations};
use fmc_adjustment::model::Model;

use super::ground_error::GroundError;
use super::strip::Strip;
use super::survey::{Errors, ObservedFrame};

/// Outcome of an adjustment.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Planimetric RMS at control points, m.
    pub control_m: f64,
    /// Planimetric RMS at check points, m.
    pub check_m: f64,
    /// Image RMS before the first and after every iteration, Yuan et al. 2012, eq. 29, mm.
    pub rms_mm: Vec<f64>,
    /// Iterations until the image RMS stays within 0.1 % of its last value.
    pub iterations: usize,
    /// Five coefficients in powers of mm.
    pub coefficients: [f64; COEFFICIENTS],
    /// Their standard deviations.
    pub coefficient_sigmas: [f64; COEFFICIENTS],
    /// σ0.
    pub sigma0: f64,
    /// Number of frames in which each element of the exterior orientation is within one σ of the
    /// truth.
    pub covered: [u32; ELEMENTS],
}

/// Relative change of the RMS below which it counts as constant.
pub const ARRIVED: f64 = 1e-3;

/// Creates the adjustment of observed frames with a model.
#[must_use]
pub fn adjustment(
    strip: &Strip,
    observed: &[ObservedFrame],
    errors: &Errors,
    model: Model,
) -> Adjustment {
    Adjustment {
        principal_distance_mm: strip.corrections.interior().principal_distance_mm,
        sigmas: errors.points,
        estimated: model.estimated(),
        initial: strip.corrections.initial(model),
        frames: observed
            .iter()
            .map(|frame| FrameObservations {
                pos: frame.pos,
                control: frame
                    .control
                    .iter()
                    .map(|point| ControlObservation {
                        corrected: strip.corrections.correct(model, point.measured_mm),
                        ground_m: point.ground_m,
                    })
                    .collect(),
            })
            .collect(),
    }
}

impl Outcome {
    /// Adjusts observed frames with a model and computes the errors of control and check points.
    ///
    /// # Errors
    /// [`AdjustmentError`] of the adjustment.
    pub fn of(
        strip: &Strip,
        observed: &[ObservedFrame],
        errors: &Errors,
        model: Model,
    ) -> Result<Self, AdjustmentError> {
        let adjusted = adjustment(strip, observed, errors, model).solve()?;
        let f_mm = strip.corrections.interior().principal_distance_mm;
        let mut control = GroundError::default();
        let mut check = GroundError::default();
        for (frame, orientation) in observed.iter().zip(&adjusted.orientations) {
            for (points, error) in [(&frame.control, &mut control), (&frame.check, &mut check)] {
                for point in points {
                    let corrected = strip.corrections.correct(model, point.measured_mm);
                    let ideal_mm = corrected.ideal(&adjusted.coefficients);
                    error.add(orientation, f_mm, ideal_mm, point.ground_m);
                }
            }
        }
        let mut coefficient_sigmas = adjusted.coefficient_sigmas;
        for (sigma, scale) in coefficient_sigmas
            .iter_mut()
            .zip(strip.corrections.scales())
        {
            *sigma /= scale;
        }
        Ok(Self {
            control_m: control.rms_m(),
            check_m: check.rms_m(),
            iterations: adjusted.iterations_to(ARRIVED),
            coefficients: strip.corrections.in_mm(&adjusted.coefficients),
            coefficient_sigmas,
            sigma0: adjusted.variance_of_unit_weight.sqrt(),
            covered: coverage(strip, &adjusted),
            rms_mm: adjusted.rms_mm,
        })
    }
}

/// Counts the frames in which each element is within one σ of the truth.
fn coverage(strip: &Strip, adjusted: &Adjusted) -> [u32; ELEMENTS] {
    let mut covered = [0; ELEMENTS];
    for ((frame, orientation), sigmas) in strip
        .frames
        .iter()
        .zip(&adjusted.orientations)
        .zip(&adjusted.orientation_sigmas)
    {
        let error = orientation.elements() - frame.orientation.elements();
        for ((covered, error), sigma) in covered.iter_mut().zip(error.iter()).zip(sigmas) {
            *covered += u32::from(error.abs() <= *sigma);
        }
    }
    covered
}
