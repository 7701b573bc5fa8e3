//! Observations and choices of the precise-angle method.

use std::sync::Arc;

use fmc_camera_file::CameraFile;

use super::budget::Uncertainty;
use super::exact::{LineAngle, LineCamera};
use super::methods::Ray;
use crate::calibration::result::InputFile;

/// Axis of the sensor frame along which the line of the sensor lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineAxis {
    /// x.
    X,
    /// y.
    Y,
}

/// A target on the line of the sensor at an angle of the turntable.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleObservation {
    /// Line in the file.
    pub line: u64,
    /// W, degrees.
    pub angle_deg: f64,
    /// L, from the centre of the sensor along its axis, mm.
    pub l_mm: f64,
    /// Spectral band.
    pub band: Option<Arc<str>>,
    /// Repetition of the measurement.
    pub repeat: Option<Arc<str>>,
}

/// Observations and choices of the precise-angle method.
#[derive(Debug, Clone)]
pub struct AnglesRequest<'a> {
    /// File of the observations.
    pub input: InputFile,
    /// Observations.
    pub observations: &'a [AngleObservation],
    /// Camera file.
    pub camera: &'a CameraFile,
    /// Axis of the line.
    pub along: LineAxis,
    /// σ of places and angles.
    pub uncertainty: Uncertainty,
    /// `true` if no observation is rejected as a gross error.
    pub keeps_all: bool,
}

/// Returns L and the tangent of W of observations, in their order.
pub(super) fn rays(observations: &[&AngleObservation]) -> Vec<Ray> {
    let observations = observations.iter();
    observations
        .map(|one| (one.l_mm, one.angle_deg.to_radians().tan()))
        .collect()
}

/// Returns the observations with σ across the ray, from a derivative of the distortion along the
/// line.
pub(super) fn line_angles(
    request: &AnglesRequest<'_>,
    observations: &[&AngleObservation],
    f_mm: f64,
    slope: impl Fn(f64) -> f64,
) -> Vec<LineAngle> {
    let Uncertainty {
        place_mm,
        angle_rad,
    } = request.uncertainty;
    let observations = observations.iter();
    observations
        .map(|one| {
            let angle = one.angle_deg.to_radians();
            LineAngle {
                l_mm: one.l_mm,
                angle_rad: angle,
                sigma_mm: (place_mm * (1.0 - slope(one.l_mm)))
                    .hypot(f_mm * angle_rad / angle.cos().powi(2)),
            }
        })
        .collect()
}

/// Returns the observations with the σ that their places have after correction of the distortion.
pub(super) fn weighted(
    request: &AnglesRequest<'_>,
    observations: &[&AngleObservation],
    camera: &LineCamera<'_>,
) -> Vec<LineAngle> {
    let [f, p, ..] = camera.unknowns;
    let distortion = camera.distortion();
    line_angles(request, observations, f, |l_mm| distortion.slope(l_mm - p))
}
