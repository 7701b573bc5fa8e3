//! Normal equations of a rig.

use nalgebra::{DMatrix, DVector};

/// Least eigenvalue of normal equations of unit diagonal: below it, unknowns are not determined.
const LEAST_EIGENVALUE: f64 = 1e-11;

/// Normal equations, summed row by row.
#[derive(Debug, Clone)]
pub(super) struct Normals {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    pub(super) squares: f64,
}

/// Solution of normal equations.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub(super) way: DVector<f64>,
    pub(super) cofactors: DMatrix<f64>,
}

/// Unknown that takes the largest part in what is not determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Undetermined(pub(super) usize);

impl Normals {
    pub(super) fn new(unknowns: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(unknowns, unknowns),
            right: DVector::zeros(unknowns),
            squares: 0.0,
        }
    }

    /// Adds an observation: derivatives by some unknowns, observed minus computed, σ.
    pub(super) fn add(&mut self, row: &[(usize, f64)], misclosure: f64, sigma: f64) {
        let weight = 1.0 / (sigma * sigma);
        for (first, a) in row {
            if let Some(slot) = self.right.get_mut(*first) {
                *slot += weight * a * misclosure;
            }
            for (second, b) in row {
                if let Some(slot) = self.matrix.get_mut((*first, *second)) {
                    *slot += weight * a * b;
                }
            }
        }
        self.squares += weight * misclosure * misclosure;
    }

    /// Solves them.
    pub(super) fn solve(&self) -> Result<Solved, Undetermined> {
        let scale = self
            .matrix
            .diagonal()
            .map(|value| value.max(f64::MIN_POSITIVE).sqrt());
        if let Some((unknown, _)) = scale.iter().enumerate().find(|(_, value)| **value < 1e-100) {
            return Err(Undetermined(unknown));
        }
        let inverse_scale = scale.map(|value| 1.0 / value);
        let scaled_by_both = |matrix: &DMatrix<f64>| {
            let mut scaled = matrix.clone();
            for (mut column, by_column) in scaled.column_iter_mut().zip(inverse_scale.iter()) {
                column.component_mul_assign(&(&inverse_scale * *by_column));
            }
            scaled
        };
        let scaled = scaled_by_both(&self.matrix);
        let weakest = |matrix: DMatrix<f64>| {
            let eigen = matrix.symmetric_eigen();
            let column = eigen.eigenvalues.imin();
            let least = eigen.eigenvalues.min();
            (least, eigen.eigenvectors.column(column).iamax())
        };
        let Some(cholesky) = scaled.clone().cholesky() else {
            return Err(Undetermined(weakest(scaled).1));
        };
        let inverse = cholesky.inverse();
        // The largest diagonal element of the inverse is at most one over the least eigenvalue.
        if inverse.diagonal().max() > 0.01 / LEAST_EIGENVALUE {
            let (least, unknown) = weakest(scaled);
            if least < LEAST_EIGENVALUE {
                return Err(Undetermined(unknown));
            }
        }
        let cofactors = scaled_by_both(&inverse);
        Ok(Solved {
            way: &cofactors * &self.right,
            cofactors,
        })
    }
}
