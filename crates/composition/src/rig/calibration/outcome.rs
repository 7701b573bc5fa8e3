//! Choices and results of a calibration.

use fmc_adjustment::exterior_orientation::ExteriorOrientation;

use crate::number::rms;
use crate::rig::description::{Heights, Rig};
use crate::rig::gauge::Movement;

/// Choices of a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigOptions {
    /// Degree of the polynomials, 2 to 5.
    pub degree: usize,
    /// Treatment of the heights of control.
    pub heights: Heights,
    /// σ of measured image points, px.
    pub sigma_px: f64,
}

/// A movement with what the data say of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovementEstimate {
    /// The movement.
    pub movement: Movement,
    /// σ from the data and a σ of 20 px before them, px; 0 of a turn of the camera.
    pub sigma_px: f64,
    /// Not separable from the orientations: the nominal value was kept, with a σ of 0.5 px.
    pub held: bool,
}

/// Residual of a point.
#[derive(Debug, Clone, PartialEq)]
pub struct RigResidual {
    /// Name of the point.
    pub id: String,
    /// Exposure.
    pub exposure: String,
    /// Number of the sub-image, of a tie the first.
    pub sub: usize,
    /// Place in the virtual image, px.
    pub place_px: [f64; 2],
    /// Polynomial less control, of a tie first less second polynomial, px.
    pub residual_px: [f64; 2],
    /// σ of either coordinate, px.
    pub sigma_px: f64,
    /// A tie, not control.
    pub is_tie: bool,
    /// Took part in the adjustment.
    pub accepted: bool,
}

/// A calibrated rig.
#[derive(Debug, Clone, PartialEq)]
pub struct RigCalibration {
    /// The rig with its polynomials.
    pub rig: Rig,
    /// Names and orientations of the exposures; those of [`Heights::Ignore`] are starts.
    pub exposures: Vec<(String, ExteriorOrientation)>,
    /// σ0.
    pub sigma0: f64,
    /// Observations less unknowns.
    pub redundancy: usize,
    /// Movements that polynomials and orientations have in common; none of [`Heights::Ignore`].
    pub movements: Vec<MovementEstimate>,
    /// All residuals.
    pub residuals: Vec<RigResidual>,
    /// Points, σ and correlations of each sub-image.
    pub subs: Vec<SubQuality>,
}

impl RigCalibration {
    /// Root mean square of a coordinate's residual over the accepted control, or ties, px.
    #[must_use]
    pub fn rms_px(&self, ties: bool) -> Option<f64> {
        let of_kind = self
            .residuals
            .iter()
            .filter(|one| one.accepted && one.is_tie == ties);
        rms(of_kind.flat_map(|one| one.residual_px))
    }

    /// Points that were rejected as gross errors.
    pub fn rejected(&self) -> impl Iterator<Item = &RigResidual> {
        self.residuals.iter().filter(|one| !one.accepted)
    }
}

/// Points, σ and correlations of a sub-image.
#[derive(Debug, Clone, PartialEq)]
pub struct SubQuality {
    /// Accepted control points.
    pub control: usize,
    /// Accepted ties.
    pub ties: usize,
    /// Largest σ of a place, px, with shift, turn, scale and keystone of the whole rig held.
    pub sigma_px: f64,
    /// Mean σ of a place, px.
    pub mean_sigma_px: f64,
    /// σ of the coefficients of u, px.
    pub sigma_u: Vec<f64>,
    /// σ of the coefficients of v, px.
    pub sigma_v: Vec<f64>,
    /// Correlations of every two coefficients, those of u before those of v.
    pub correlations: Vec<Correlation>,
}

impl SubQuality {
    /// The correlation farthest from 0; `None` of no coefficients.
    #[must_use]
    pub fn largest_correlation(&self) -> Option<&Correlation> {
        let size = |one: &&Correlation| one.value.abs();
        let list = self.correlations.iter();
        list.max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// Correlation of two coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Their names.
    pub names: [String; 2],
    /// The coefficient of correlation.
    pub value: f64,
}
