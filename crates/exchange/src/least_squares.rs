//! Damped least squares of few unknowns and many observations.

use nalgebra::{DMatrix, DVector};

/// Singular values below this part of the largest are those of combinations that the observations
/// do not determine.
const LEAST_SINGULAR: f64 = 1e-13;

/// A linearised problem: columns of unit length, decomposed.
#[derive(Debug)]
pub(crate) struct Linearised {
    scales: Vec<f64>,
    right: DVector<f64>,
    left: DMatrix<f64>,
    values: DVector<f64>,
}

impl Linearised {
    /// Decomposes the design with the right-hand side; `None` where a number is not finite.
    pub(crate) fn new(mut design: DMatrix<f64>, observed: &DVector<f64>) -> Option<Self> {
        let mut scales = Vec::with_capacity(design.ncols());
        for mut column in design.column_iter_mut() {
            let length = column.norm();
            let scale = if length > 0.0 { length } else { 1.0 };
            column /= scale;
            scales.push(scale);
        }
        let qr = design.qr();
        let mut rotated = observed.clone();
        qr.q_tr_mul(&mut rotated);
        let upper = qr.r();
        let rotated = rotated.rows(0, upper.nrows()).into_owned();
        if upper.iter().chain(rotated.iter()).any(|x| !x.is_finite()) {
            return None;
        }
        let svd = upper.try_svd(true, true, f64::EPSILON, 0)?;
        let right = svd.u?.tr_mul(&rotated);
        Some(Self {
            scales,
            right,
            left: svd.v_t?.transpose(),
            values: svd.singular_values,
        })
    }

    /// Returns the solution with the damping `damping`; 0 for none.
    pub(crate) fn solve(&self, damping: f64) -> Vec<f64> {
        let floor = LEAST_SINGULAR * self.values.max();
        let parts = self.right.zip_map(&self.values, |part, value| {
            if value > floor {
                part * value / (value * value + damping)
            } else {
                0.0
            }
        });
        let solution = &self.left * parts;
        solution
            .iter()
            .zip(&self.scales)
            .map(|(part, scale)| part / scale)
            .collect()
    }
}

/// Returns the unknowns of a linear problem: `rows` are the coefficients of the unknowns with the
/// observation.
pub(crate) fn linear<const N: usize>(rows: &[([f64; N], f64)]) -> Option<[f64; N]> {
    let design = DMatrix::from_row_iterator(rows.len(), N, rows.iter().flat_map(|(row, _)| *row));
    let observed = DVector::from_iterator(rows.len(), rows.iter().map(|(_, value)| *value));
    Linearised::new(design, &observed)?
        .solve(0.0)
        .try_into()
        .ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_through_its_points_is_found() {
        let rows = [0.0, 1.0, 2.0].map(|x: f64| ([1.0, x], 3.0 - 0.5 * x));
        let [a, b] = linear(&rows).unwrap();
        assert!((a - 3.0).abs() < 1e-14 && (b + 0.5).abs() < 1e-14);
    }

    #[test]
    fn combination_that_is_not_determined_stays_zero() {
        let rows = [1.0, 2.0, 3.0].map(|x: f64| ([x, x], 2.0 * x));
        let [a, b] = linear(&rows).unwrap();
        assert!((a - 1.0).abs() < 1e-12 && (b - 1.0).abs() < 1e-12);
        assert_eq!(linear(&[([f64::NAN], 1.0)]), None);
    }
}
