//! The distortion along a row: a polynomial in X for each axis.

use crate::geometry::evaluation_form::EvaluationForm;

/// Coefficients of Dx and Dy along a row of fixed Y, lowest power of X first, mm and X in mm.
///
/// # Model
/// The evaluation form with `R = X² + S`, `S = Y²`:
/// `G = g₀ + hx·X + g₂X² + g₄X⁴ + k₃X⁶` with `g₀ = k₀ + hy·Y + S(k₁ + S(k₂ + S·k₃))`,
/// `g₂ = k₁ + S(2k₂ + 3S·k₃)`, `g₄ = k₂ + 3S·k₃`; then
/// `Dx = (gx·S + b₂Y + tx) + (g₀ + b₁)X + (hx + gx)X² + g₂X³ + g₄X⁵ + k₃X⁷` and
/// `Dy = (Y·g₀ + gy·S + ty) + Y·hx·X + (Y·g₂ + gy)X² + Y·g₄X⁴ + Y·k₃X⁶`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RowPolynomial {
    pub(super) dx: [f32; 8],
    pub(super) dy: [f32; 7],
}

impl RowPolynomial {
    /// Along the row `y` mm above the centre.
    pub(super) fn new(form: &EvaluationForm, y: f32) -> Self {
        let s = y * y;
        let s_k3 = 3.0 * (s * form.k3);
        let g0 = form.k0 + form.hy * y + s * (form.k1 + s * (form.k2 + s * form.k3));
        let g2 = form.k1 + s * (2.0 * form.k2 + s_k3);
        let g4 = form.k2 + s_k3;
        Self {
            dx: [
                form.gx * s + form.b2 * y + form.tx,
                g0 + form.b1,
                form.hx + form.gx,
                g2,
                0.0,
                g4,
                0.0,
                form.k3,
            ],
            dy: [
                y * g0 + form.gy * s + form.ty,
                y * form.hx,
                y * g2 + form.gy,
                0.0,
                y * g4,
                0.0,
                y * form.k3,
            ],
        }
    }

    /// The coefficients that can differ from zero where K3 = 0.
    pub(super) const fn without_k3(&self) -> ([f32; 6], [f32; 5]) {
        let [a0, a1, a2, a3, a4, a5, _, _] = self.dx;
        let [b0, b1, b2, b3, b4, _, _] = self.dy;
        ([a0, a1, a2, a3, a4, a5], [b0, b1, b2, b3, b4])
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
            assert!((value(&row.dx) - expected.dx_mm).abs() < 5e-8);
            assert!((value(&row.dy) - expected.dy_mm).abs() < 5e-8);
        }
    }
}
