//! The five fitted coefficients of the dynamic model.

use super::evaluation_form::EvaluationForm;
use super::principal_point::PrincipalPointMotion;
use super::range::{OutOfRange, Quantity, check_finite};
use super::sensor::FmcAxis;

/// Regressor of `K_d1` and `P_m1`: the motion by which they are multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Regressor {
    /// δ, the travel while the shutter is open (Yuan et al. 2012, eq. 22). It is right where Δδ/δ
    /// is the same in all exposures.
    #[default]
    Travel,
    /// c̄, the offset of the exposure centroid (Δδ + δ/2 for a uniform shutter), to which the terms
    /// are proportional.
    Centroid,
}

/// Coefficients `K_m0`, `K_m1`, `K_m2`, `K_d1`, `P_m1` as fitted to calibration exposures.
///
/// `K_m0..K_m2` *replace* K0..K2 of the static calibration; K3, P, B stay. The printed feed-forward
/// values (`K_d1` = 2K1, `P_m1` = K1) have the wrong sign and are never used.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FiveCoefficients {
    /// `K_m0`, dimensionless.
    pub km0: f32,
    /// `K_m1`, mm⁻².
    pub km1: f32,
    /// `K_m2`, mm⁻⁴.
    pub km2: f32,
    /// `K_d1`, mm⁻².
    pub kd1: f32,
    /// `P_m1`, mm⁻².
    pub pm1: f32,
    /// Regressor of `kd1` and `pm1`.
    pub regressor: Regressor,
}

impl FiveCoefficients {
    /// Quantities of [`Self::coefficients`].
    const QUANTITIES: [Quantity; 5] = [
        Quantity::Km0,
        Quantity::Km1,
        Quantity::Km2,
        Quantity::Kd1,
        Quantity::Pm1,
    ];

    /// The coefficients, in the order of the fields.
    pub(crate) const fn coefficients(&self) -> [f32; 5] {
        [self.km0, self.km1, self.km2, self.kd1, self.pm1]
    }

    /// Checks that all coefficients are finite numbers.
    ///
    /// # Errors
    /// [`OutOfRange`], which names the first that is not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        check_finite(&Self::QUANTITIES, &self.coefficients())
    }

    /// Returns the regressor of `K_d1` and `P_m1` in a frame of this motion, mm.
    #[must_use]
    pub const fn regressor_mm(&self, motion: &PrincipalPointMotion) -> f32 {
        match self.regressor {
            Regressor::Travel => motion.travel_mm,
            Regressor::Centroid => motion.centroid_mm,
        }
    }

    /// Adds the model at `regressor_mm` (δ, or c̄ by [`Self::regressor_mm`]) along `axis` to the
    /// static `form`.
    ///
    /// # Model
    /// Yuan et al. 2012, eq. 22, with e = +y:
    /// `ΔPx = Km0x̄ + Km1x̄r² + Km2x̄r⁴ + Kd1δx̄ȳ`,
    /// `ΔPy = Km0ȳ + Km1ȳr² + Km2ȳr⁴ + Kd1δȳ² + Pm1δr²`, about the calibrated principal point; with
    /// [`Regressor::Centroid`], c̄ in place of δ.
    #[must_use]
    pub fn folded(&self, form: EvaluationForm, regressor_mm: f32, axis: FmcAxis) -> EvaluationForm {
        let signed_mm = axis.sign() * regressor_mm;
        let mut folded = EvaluationForm {
            k0: self.km0,
            k1: self.km1,
            k2: self.km2,
            ..form
        };
        let (h, g) = if axis.is_x() {
            (&mut folded.hx, &mut folded.gx)
        } else {
            (&mut folded.hy, &mut folded.gy)
        };
        *h += self.kd1 * signed_mm;
        *g += self.pm1 * signed_mm;
        folded
    }
}
