//! Bound on the rounding along a row of differences;
//! [`DisplacementRows`](super::displacement_rows::DisplacementRows) explains its parts.

use core::num::NonZero;

use super::row_polynomial::RowPolynomial;
use crate::geometry::evaluation_form::EvaluationForm;

/// u: half a unit in the last place, relative.
pub(super) const UNIT_ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// Number of roundings of the terms without k on their way into the differences, Y and its product
/// with G included.
const FOLD_OF_OTHERS: f32 = 8.0;

/// Factor for the terms of second order, as only those of first order are counted. The others -
/// products of roundings, a start that rounding puts on the far side of the centre by 6u of the
/// reach, the roundings of the bound itself - are less than a thousandth of the bound.
pub(super) const SECOND_ORDER: f32 = 1.001;

/// Parts of the bound of a frame.
#[derive(Debug)]
pub(super) struct RoundingBound {
    /// Half a unit in the last place of the largest distortion per axis, in u.
    half_unit: [f32; 2],
    /// Largest |G|; `beside_x` is the largest value of the terms beside X·G.
    gain: f32,
    beside_x: f32,
    /// Â and Ẑ at the reach.
    at_reach: [Magnitude; 2],
    /// Contribution of the start of the differences, which does not depend on the interval.
    start: [f32; 2],
    /// Absolute values of the coefficients at the largest |Y|.
    row: RowPolynomial,
    reach: f32,
}

impl RoundingBound {
    /// Returns the bound for rows with |X| and |Y| up to `reach`.
    pub(super) fn new(form: &EvaluationForm, reach: [f32; 2]) -> Self {
        let [reach_x, reach_y] = reach;
        let absolute = absolute(form);
        let others = EvaluationForm {
            k1: 0.0,
            k2: 0.0,
            k3: 0.0,
            ..absolute
        };
        let row = RowPolynomial::new(&absolute, reach_y);
        let at_reach = magnitudes(&row, reach_x);
        let beside = others.displacement(reach_x, reach_y);
        let beside_slope = others.jacobian(reach_x, reach_y);
        let end = reach_x * reach_x + reach_y * reach_y;
        let gain = largest_of_cubic([0.0, form.k1, form.k2, form.k3], end);
        // ∂(X·G)/∂X = G + X²·2dG/dR, ∂(Y·G)/∂X = XY·2dG/dR: the first lies between G and G +
        // 2R·dG/dR.
        let across = [0.0, 2.0 * form.k1, 4.0 * form.k2, 6.0 * form.k3];
        let across = largest_of_cubic(across, end);
        let radial = [0.0, 3.0 * form.k1, 5.0 * form.k2, 7.0 * form.k3];
        let along = gain.max(largest_of_cubic(radial, end));
        let fold = fold_of_k(&absolute, reach);
        let axis = |at_reach: Magnitude, slope: f32, fold: f32| {
            at_reach.value + 2.0 * at_reach.by_degree + 4.0 * reach_x * slope + fold
        };
        let [at_reach_x, at_reach_y] = at_reach;
        Self {
            half_unit: [
                power_of_two_within(reach_x * gain + beside.dx_mm),
                power_of_two_within(reach_y * gain + beside.dy_mm),
            ],
            gain,
            beside_x: beside.dx_mm,
            at_reach,
            start: [
                axis(
                    at_reach_x,
                    along + beside_slope.dx_by_x,
                    reach_x * fold + FOLD_OF_OTHERS * beside.dx_mm,
                ),
                axis(
                    at_reach_y,
                    // |XY| is at most R/2.
                    0.5 * across + beside_slope.dy_by_x,
                    reach_y * fold + FOLD_OF_OTHERS * beside.dy_mm,
                ),
            ],
            row,
            reach: reach_x,
        }
    }

    /// Returns the bound for the larger of the two axes, nm; it rises with the interval.
    pub(super) fn nanometres(&self, interval: NonZero<u16>, step_mm: f32) -> f32 {
        // `f32::max` would drop a NaN.
        if !(step_mm + self.reach).is_finite() {
            return f32::NAN;
        }
        let step = step_mm.abs();
        // Runs of additions are no longer than from the centre to the edge.
        let additions = (f32::from(interval.get()) - 1.0).min(self.reach / step);
        let length = additions * step;
        // Distance from the first to the last of the points that are added to.
        let span = (length - step).max(0.0);
        let inside = |distance: f32| magnitudes(&self.row, (self.reach - distance).max(0.0));
        let outer = inside(0.25 * span);
        let inner = inside(0.75 * span);
        let first = inside(length);
        let axis = |addition: f32, start: f32, [at_reach, outer, inner, first]: [&Magnitude; 4]| {
            let mean = 0.5 * (outer.value + inner.value);
            additions * (addition + (at_reach.value - mean))
                + start
                + 2.0 * (at_reach.by_degree - first.by_degree)
        };
        let [half_unit_x, half_unit_y] = self.half_unit;
        // Along the way |Dx| rises with |X|, so that the mean |X| bounds its mean.
        let middle = self.reach - 0.5 * span;
        let half_unit_x = half_unit_x.min(middle * self.gain + self.beside_x);
        let [start_x, start_y] = self.start;
        let [
            [reach_x, reach_y],
            [outer_x, outer_y],
            [inner_x, inner_y],
            [first_x, first_y],
        ] = [&self.at_reach, &outer, &inner, &first].map(|[x, y]| [x, y]);
        let dx = axis(half_unit_x, start_x, [reach_x, outer_x, inner_x, first_x]);
        let dy = axis(half_unit_y, start_y, [reach_y, outer_y, inner_y, first_y]);
        SECOND_ORDER * 1e6 * UNIT_ROUNDOFF * dx.max(dy)
    }
}

/// `Â = Σ|a_m|Xᵐ` and `Ẑ = Σ m|a_m|Xᵐ` of one axis.
#[derive(Debug, Clone, Copy)]
struct Magnitude {
    value: f32,
    by_degree: f32,
}

/// Returns the magnitudes of both axes, from absolute values of the coefficients.
fn magnitudes(row: &RowPolynomial, x: f32) -> [Magnitude; 2] {
    let [gain, gain_by_degree] = value_and_by_degree(&row.gain(), x);
    let [beside_x, beside_x_by_degree] = value_and_by_degree(&row.beside_x, x);
    let [beside_y, beside_y_by_degree] = value_and_by_degree(&row.beside_y(), x);
    [
        Magnitude {
            value: x * gain + beside_x,
            by_degree: x * (gain + gain_by_degree) + beside_x_by_degree,
        },
        Magnitude {
            value: row.y * gain + beside_y,
            by_degree: row.y * gain_by_degree + beside_y_by_degree,
        },
    ]
}

/// Returns the roundings of k₁ to k₃ on their way into the differences of Dy: G of their absolute
/// values, each multiplied by its number of roundings.
///
/// S brings three roundings, each step of a Horner scheme two. Three are added to those counted on
/// the way into g₀, g₂ and g₄: Y, its product, and the sum with the terms beside G. Dx has one of
/// them.
fn fold_of_k(absolute: &EvaluationForm, [reach_x, reach_y]: [f32; 2]) -> f32 {
    let EvaluationForm { k1, k2, k3, .. } = *absolute;
    let [x2, s] = [reach_x * reach_x, reach_y * reach_y];
    let g0 = s * (9.0 * k1 + s * (14.0 * k2 + s * (18.0 * k3)));
    let g2 = 4.0 * k1 + s * (9.0 * 2.0 * k2 + s * (14.0 * 3.0 * k3));
    let g4 = 4.0 * k2 + s * (9.0 * 3.0 * k3);
    g0 + x2 * (g2 + x2 * (g4 + x2 * (3.0 * k3)))
}

/// Returns the largest absolute value of a cubic in R, lowest power first, over 0 ≤ R ≤ `end`,
/// bounded by its Bernstein coefficients.
pub(super) fn largest_of_cubic([c0, c1, c2, c3]: [f32; 4], end: f32) -> f32 {
    let linear = c1 * end / 3.0;
    let square = c2 * end * end / 3.0;
    let cube = c3 * end * end * end;
    [
        c0,
        c0 + linear,
        c0 + 2.0 * linear + square,
        c0 + 3.0 * linear + 3.0 * square + cube,
    ]
    .into_iter()
    .fold(0.0, |largest, coefficient| coefficient.abs().max(largest))
}

/// Returns the largest power of two that is not more than a positive number, to a thousandth: half
/// a unit in the last place of that number is u times the power.
pub(super) fn power_of_two_within(number: f32) -> f32 {
    const EXPONENT: u32 = 0x7f80_0000;
    f32::from_bits((SECOND_ORDER * number).to_bits() & EXPONENT)
}

/// Returns the form with absolute values of the coefficients.
pub(super) fn absolute(form: &EvaluationForm) -> EvaluationForm {
    EvaluationForm {
        k0: form.k0.abs(),
        k1: form.k1.abs(),
        k2: form.k2.abs(),
        k3: form.k3.abs(),
        hx: form.hx.abs(),
        hy: form.hy.abs(),
        gx: form.gx.abs(),
        gy: form.gy.abs(),
        b1: form.b1.abs(),
        b2: form.b2.abs(),
        tx: form.tx.abs(),
        ty: form.ty.abs(),
    }
}

/// Returns `Σ a_m·xᵐ` and `Σ m·a_m·xᵐ`, coefficients lowest power first.
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
        let cubic = [0.0, 2.5e-6, -1.6e-10, 5e-15];
        let [_, k1, k2, k3] = cubic;
        let end = 5408.0;
        let at_the_end = end * (k1 + end * (k2 + end * k3));
        assert!((largest_of_cubic(cubic, end) - at_the_end).abs() < 1e-8);
        // The sum of absolute values would be 1.9 times as much.
        assert!(at_the_end < 0.0097);
    }

    #[test]
    fn half_a_unit_in_the_last_place_is_that_of_the_power_of_two_within() {
        for (number, power) in [(0.3, 0.25), (0.25, 0.25), (0.2499, 0.25), (0.2, 0.125)] {
            assert_eq!(power_of_two_within(number).to_bits(), f32::to_bits(power));
        }
        assert_eq!(power_of_two_within(0.0).to_bits(), 0);
    }
}
