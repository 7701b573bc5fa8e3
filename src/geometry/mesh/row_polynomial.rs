//! Polynomials of a row: the distortion as a function of X for each axis.

use super::differences::ABSENT;
use crate::geometry::evaluation_form::EvaluationForm;

/// Dx and Dy along a row of fixed Y, mm and X in mm: `Dx = X·G + qx`, `Dy = Y·G + qy`.
///
/// # Model
/// The evaluation form with `R = X² + S`, `S = Y²`:
/// `G = g₀ + hx·X + g₂X² + g₄X⁴ + k₃X⁶` with `g₀ = k₀ + hy·Y + S(k₁ + S(k₂ + S·k₃))`,
/// `g₂ = k₁ + S(2k₂ + 3S·k₃)`, `g₄ = k₂ + 3S·k₃`; beside it
/// `qx = (gx·S + b₂Y + tx) + b₁X + gx·X²` and `qy = (gy·S + ty) + gy·X²`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RowPolynomial {
    pub(super) y: f32,
    /// Coefficients of 1, X, X², X⁴ and X⁶.
    gain: [f32; 5],
    /// qx, lowest power of X first.
    pub(super) beside_x: [f32; 3],
    /// Coefficients of 1 and X² in qy.
    beside_y: [f32; 2],
}

impl RowPolynomial {
    /// Returns the polynomials of the row `y` mm above the centre.
    #[inline]
    pub(super) fn new(form: &EvaluationForm, y: f32) -> Self {
        let s = y * y;
        let s_k3 = 3.0 * (s * form.k3);
        let g0 = form.k0 + form.hy * y + s * (form.k1 + s * (form.k2 + s * form.k3));
        let g2 = form.k1 + s * (2.0 * form.k2 + s_k3);
        let g4 = form.k2 + s_k3;
        Self {
            y,
            gain: [g0, form.hx, g2, g4, form.k3],
            beside_x: [form.gx * s + form.b2 * y + form.tx, form.b1, form.gx],
            beside_y: [form.gy * s + form.ty, form.gy],
        }
    }

    /// Returns the coefficients of G, lowest power of X first.
    #[inline]
    pub(super) const fn gain(&self) -> [f32; 7] {
        let [g0, g1, g2, g4, g6] = self.gain;
        [g0, g1, g2, ABSENT, g4, ABSENT, g6]
    }

    /// Returns the coefficients of G where K3 = 0.
    #[inline]
    pub(super) const fn gain_without_k3(&self) -> [f32; 5] {
        let [g0, g1, g2, g4, _] = self.gain;
        [g0, g1, g2, ABSENT, g4]
    }

    /// Returns the coefficients of qy, lowest power of X first.
    #[inline]
    pub(super) const fn beside_y(&self) -> [f32; 3] {
        let [q0, q2] = self.beside_y;
        [q0, ABSENT, q2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_the_evaluation_form_along_the_row() {
        let form = EvaluationForm {
            k0: 1e-3,
            k1: -2e-6,
            k2: 4e-10,
            k3: -5e-14,
            hx: 3e-6,
            hy: -2e-6,
            gx: 1e-6,
            gy: 2e-6,
            b1: 1e-4,
            b2: -2e-4,
            tx: 1e-4,
            ty: -3e-4,
        };
        let row = RowPolynomial::new(&form, -20.0);
        for x in [-30.0_f32, -1.0, 0.0, 12.5, 30.0] {
            let value = |coefficients: &[f32]| {
                let terms = coefficients.iter().rev();
                terms.fold(0.0, |sum, coefficient| sum * x + coefficient)
            };
            let expected = form.displacement(x, -20.0);
            // Terms of up to 0.1 mm in single precision: 0.05 nm.
            let dx_mm = x * value(&row.gain()) + value(&row.beside_x);
            let dy_mm = row.y * value(&row.gain()) + value(&row.beside_y());
            assert!((dx_mm - expected.dx_mm).abs() < 5e-8);
            assert!((dy_mm - expected.dy_mm).abs() < 5e-8);
        }
    }
}
