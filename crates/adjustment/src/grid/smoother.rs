//! Normal equations of the coefficients of residual grids, sparse.

use std::collections::BTreeMap;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use super::roughness::Difference;

/// Error: the coefficients of the grids are not determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the coefficients of the grid are not determined")]
pub(super) struct Undetermined;

/// Factor of the normal equations of the coefficients.
#[derive(Debug)]
pub(super) struct Smoother<'a> {
    rows: &'a [Vec<(usize, f64)>],
    unknowns: usize,
    factor: Llt<usize, f64>,
}

impl<'a> Smoother<'a> {
    /// Returns the factor for rows of the design, penalties with their weight, and the weight of
    /// the coefficients themselves.
    pub(super) fn new(
        rows: &'a [Vec<(usize, f64)>],
        penalties: &[Difference],
        penalty_weight: f64,
        unknowns: usize,
        coefficient_weight: f64,
    ) -> Result<Self, Undetermined> {
        let mut elements: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for node in 0..unknowns {
            elements.insert((node, node), coefficient_weight);
        }
        let weighted = rows
            .iter()
            .map(|row| (row, 1.0))
            .chain(penalties.iter().map(|row| (row, penalty_weight)));
        for (row, weight) in weighted {
            for (column, a) in row {
                for (line, b) in row {
                    if line >= column {
                        *elements.entry((*column, *line)).or_default() += weight * a * b;
                    }
                }
            }
        }
        let triplets: Vec<_> = elements
            .into_iter()
            .map(|((column, line), value)| Triplet::new(line, column, value))
            .collect();
        let matrix = SparseColMat::try_new_from_triplets(unknowns, unknowns, &triplets)
            .map_err(|_| Undetermined)?;
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|_| Undetermined)?;
        Ok(Self {
            rows,
            unknowns,
            factor,
        })
    }

    /// Returns the coefficients that fit observations, penalties included.
    pub(super) fn coefficients(&self, observed: &[f64]) -> Vec<f64> {
        let mut right = Mat::zeros(self.unknowns, 1);
        for (row, observed) in self.rows.iter().zip(observed) {
            for (node, weight) in row {
                if let Some(element) = right.col_as_slice_mut(0).get_mut(*node) {
                    *element += weight * observed;
                }
            }
        }
        let solution = self.factor.solve(&right);
        solution.col_as_slice(0).to_vec()
    }

    /// Returns what coefficients predict.
    pub(super) fn predicted(&self, coefficients: &[f64]) -> Vec<f64> {
        let value = |row: &Vec<(usize, f64)>| {
            row.iter()
                .filter_map(|(node, weight)| Some(weight * coefficients.get(*node)?))
                .sum()
        };
        self.rows.iter().map(value).collect()
    }

    /// Returns observations less what the coefficients that fit them predict.
    pub(super) fn left(&self, observed: &[f64]) -> Vec<f64> {
        let predicted = self.predicted(&self.coefficients(observed));
        observed
            .iter()
            .zip(predicted)
            .map(|(observed, predicted)| observed - predicted)
            .collect()
    }
}
