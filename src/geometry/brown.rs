//! Brown's polynomial: the static distortion of a lens.

use super::evaluation_form::{Displacement, EvaluationForm, Jacobian};
use super::range::{OutOfRange, Quantity, check_finite};

/// Coefficients of the static distortion, *measured - ideal*, about the principal point.
///
/// Brown/Australis order: P1 goes with x̄². Published *corrections* have the opposite sign.
#[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Brown {
    /// K0, dimensionless: the gauge of the principal distance.
    pub k0: f32,
    /// K1, mm⁻².
    pub k1: f32,
    /// K2, mm⁻⁴.
    pub k2: f32,
    /// K3, mm⁻⁶.
    pub k3: f32,
    /// P1, mm⁻¹.
    pub p1: f32,
    /// P2, mm⁻¹.
    pub p2: f32,
    /// B1, dimensionless: affinity.
    pub b1: f32,
    /// B2, dimensionless: shear.
    pub b2: f32,
}

impl Brown {
    /// A lens without distortion.
    pub const NONE: Self = Self {
        k0: 0.0,
        k1: 0.0,
        k2: 0.0,
        k3: 0.0,
        p1: 0.0,
        p2: 0.0,
        b1: 0.0,
        b2: 0.0,
    };

    /// Quantities of the fields, in their order.
    const QUANTITIES: [Quantity; 8] = [
        Quantity::K0,
        Quantity::K1,
        Quantity::K2,
        Quantity::K3,
        Quantity::P1,
        Quantity::P2,
        Quantity::B1,
        Quantity::B2,
    ];

    /// The coefficients, in the order of the fields.
    pub(crate) fn coefficients(&self) -> &[f32; 8] {
        bytemuck::must_cast_ref(self)
    }

    /// Checks that all coefficients are finite numbers.
    ///
    /// # Errors
    /// [`OutOfRange`], which names the first that is not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        check_finite(&Self::QUANTITIES, self.coefficients())
    }

    /// Returns the static distortion at a point relative to the principal point.
    ///
    /// # Model
    /// `Dx = x̄(K0 + K1r² + K2r⁴ + K3r⁶) + P1(r² + 2x̄²) + 2P2x̄ȳ + B1x̄ + B2ȳ`,
    /// `Dy = ȳ(K0 + K1r² + K2r⁴ + K3r⁶) + P2(r² + 2ȳ²) + 2P1x̄ȳ`
    /// (Yuan et al. 2012, eq. 1, with Brown's decentring and affinity), evaluated as the
    /// [`EvaluationForm`] with hx = 2P1, hy = 2P2, gx = P1, gy = P2.
    ///
    /// # Units and frames
    /// `x`, `y` in mm of the sensor frame from the principal point; displacement in mm, measured -
    /// ideal.
    ///
    /// # Accuracy
    /// Rounding ≤ 0.37 nm for the published calibrations (proved, `docs/rounding.md`), of which
    /// 0.11 nm were found (`tests/geometry/accuracy.rs`).
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::brown::Brown;
    /// let lens = Brown { k1: 1e-5, ..Brown::default() };
    /// let d = lens.displacement(10.0, 0.0); // K1·r³ = 0.01 mm
    /// assert!((d.dx_mm - 0.01).abs() < 1e-8 && d.dy_mm == 0.0);
    /// ```
    #[must_use]
    pub fn displacement(&self, x: f32, y: f32) -> Displacement {
        self.evaluation_form().displacement(x, y)
    }

    /// Returns the derivatives of [`Self::displacement`] by x and y.
    #[must_use]
    pub fn jacobian(&self, x: f32, y: f32) -> Jacobian {
        self.evaluation_form().jacobian(x, y)
    }

    /// Returns the same polynomial in the form in which every model is evaluated.
    #[must_use]
    pub fn evaluation_form(&self) -> EvaluationForm {
        EvaluationForm {
            k0: self.k0,
            k1: self.k1,
            k2: self.k2,
            k3: self.k3,
            hx: 2.0 * self.p1,
            hy: 2.0 * self.p2,
            gx: self.p1,
            gy: self.p2,
            b1: self.b1,
            b2: self.b2,
            tx: 0.0,
            ty: 0.0,
        }
    }
}
