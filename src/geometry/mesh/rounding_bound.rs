//! What rounding can come to along a row of differences: the bound of
//! [`DisplacementRows`](super::displacement_rows::DisplacementRows), where its parts are explained.

use core::num::NonZero;

use super::row_polynomial::RowPolynomial;
use crate::geometry::evaluation_form::EvaluationForm;

/// u: half a unit in the last place, relative.
const UNIT_ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// Roundings on the way of k₀ to k₃ into a coefficient of a row: 3 for Y² and 2 for each Horner step, then the sums.
const FOLD_OF_K: [f32; 4] = [6.0, 11.0, 16.0, 21.0];
/// The same for all other terms.
const FOLD_OF_OTHERS: f32 = 8.0;

/// What the bound of a frame is made of.
#[derive(Debug)]
pub(super) struct RoundingBound {
    /// Largest distortion per axis, mm.
    largest: [f32; 2],
    /// Absolute values of the coefficients at the largest |Y|.
    row: RowPolynomial,
    /// The same, each coefficient of the form times its roundings.
    fold: RowPolynomial,
    reach: f32,
}

impl RoundingBound {
    /// For rows with |X| and |Y| up to `reach`.
    pub(super) fn new(form: &EvaluationForm, [reach_x, reach_y]: [f32; 2]) -> Self {
        let absolute = weighted(form, [1.0; 4], 1.0);
        let beside_k = weighted(form, [0.0; 4], 1.0).displacement(reach_x, reach_y);
        let gain = largest_gain(form, reach_x * reach_x + reach_y * reach_y);
        Self {
            largest: [
                reach_x * gain + beside_k.dx_mm,
                reach_y * gain + beside_k.dy_mm,
            ],
            row: RowPolynomial::new(&absolute, reach_y),
            fold: RowPolynomial::new(&weighted(form, FOLD_OF_K, FOLD_OF_OTHERS), reach_y),
            reach: reach_x,
        }
    }

    /// The bound for the larger of the two axes, nm.
    pub(super) fn nanometres(&self, interval: NonZero<u16>, step_mm: f32) -> f32 {
        let additions = f32::from(interval.get()) - 1.0;
        let beyond = self.reach + additions * step_mm.abs();
        let axis = |largest: f32, row: &[f32], fold: &[f32]| {
            let [near, near_by_degree] = value_and_by_degree(row, self.reach);
            let [far, far_by_degree] = value_and_by_degree(row, beyond);
            let [folded, _] = value_and_by_degree(fold, beyond);
            additions * (largest + 0.5 * (far - near))
                + far
                + folded
                + 6.0 * far_by_degree
                + (far + 10.0 * far_by_degree)
                - (near + 10.0 * near_by_degree)
        };
        let [largest_dx, largest_dy] = self.largest;
        let dx = axis(largest_dx, &self.row.dx, &self.fold.dx);
        let dy = axis(largest_dy, &self.row.dy, &self.fold.dy);
        1e6 * UNIT_ROUNDOFF * dx.max(dy)
    }
}

/// The largest `|k₀ + k₁R + k₂R² + k₃R³|` over 0 ≤ R ≤ `end`, bounded by its Bernstein coefficients.
fn largest_gain(form: &EvaluationForm, end: f32) -> f32 {
    let linear = form.k1 * end / 3.0;
    let square = form.k2 * end * end / 3.0;
    let cube = form.k3 * end * end * end;
    [
        form.k0,
        form.k0 + linear,
        form.k0 + 2.0 * linear + square,
        form.k0 + 3.0 * linear + 3.0 * square + cube,
    ]
    .into_iter()
    .fold(0.0, |largest, coefficient| coefficient.abs().max(largest))
}

/// Absolute values of the coefficients, times weights.
fn weighted(form: &EvaluationForm, [w0, w1, w2, w3]: [f32; 4], others: f32) -> EvaluationForm {
    EvaluationForm {
        k0: w0 * form.k0.abs(),
        k1: w1 * form.k1.abs(),
        k2: w2 * form.k2.abs(),
        k3: w3 * form.k3.abs(),
        hx: others * form.hx.abs(),
        hy: others * form.hy.abs(),
        gx: others * form.gx.abs(),
        gy: others * form.gy.abs(),
        b1: others * form.b1.abs(),
        b2: others * form.b2.abs(),
        tx: others * form.tx.abs(),
        ty: others * form.ty.abs(),
    }
}

/// `Σ a_m·xᵐ` and `Σ m·a_m·xᵐ`, lowest power first.
fn value_and_by_degree(coefficients: &[f32], x: f32) -> [f32; 2] {
    let from_the_highest = coefficients.iter().rev();
    let [value, slope] = from_the_highest.fold([0.0, 0.0], |[value, slope], coefficient| {
        [value * x + coefficient, slope * x + value]
    });
    [value, slope * x]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_gain_is_that_at_the_end_where_terms_of_both_signs_rise_together() {
        let form = EvaluationForm {
            k1: 2.5e-6,
            k2: -1.6e-10,
            k3: 5e-15,
            ..EvaluationForm::default()
        };
        let end = 5408.0;
        let at_the_end = end * (form.k1 + end * (form.k2 + end * form.k3));
        assert!((largest_gain(&form, end) - at_the_end).abs() < 1e-8);
        // The sum of absolute values would be 1.9 times as much.
        assert!(at_the_end < 0.0097);
    }
}
