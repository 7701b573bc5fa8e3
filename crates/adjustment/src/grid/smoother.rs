//! Normal equations of the coefficients of residual grids, sparse.

use std::collections::BTreeMap;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use super::roughness::Difference;

/// Columns of the inverse that are computed together.
const COLUMNS: usize = 64;

/// Error: the coefficients of the grids are not determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the coefficients of the grid are not determined")]
pub(super) struct Undetermined;

/// Factor of the normal equations of the coefficients.
#[derive(Debug)]
pub(super) struct Smoother<'a> {
    rows: &'a [Vec<(usize, f64)>],
    unknowns: usize,
    /// None without unknowns.
    factor: Option<Llt<usize, f64>>,
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
        if unknowns == 0 {
            return Ok(Self {
                rows,
                unknowns,
                factor: None,
            });
        }
        // Of each column the elements from the diagonal on.
        let mut columns: Vec<BTreeMap<usize, f64>> = (0..unknowns)
            .map(|node| BTreeMap::from([(node, coefficient_weight)]))
            .collect();
        let weighted = rows
            .iter()
            .map(|row| (row, 1.0))
            .chain(penalties.iter().map(|row| (row, penalty_weight)));
        for (row, weight) in weighted {
            for (column, a) in row {
                let Some(column_elements) = columns.get_mut(*column) else {
                    return Err(Undetermined);
                };
                for (line, b) in row.iter().filter(|(line, _)| line >= column) {
                    *column_elements.entry(*line).or_default() += weight * a * b;
                }
            }
        }
        let triplets: Vec<_> = columns
            .into_iter()
            .enumerate()
            .flat_map(|(column, elements)| {
                let elements = elements.into_iter();
                elements.map(move |(line, value)| Triplet::new(line, column, value))
            })
            .collect();
        let matrix = SparseColMat::try_new_from_triplets(unknowns, unknowns, &triplets)
            .map_err(|_| Undetermined)?;
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|_| Undetermined)?;
        Ok(Self {
            rows,
            unknowns,
            factor: Some(factor),
        })
    }

    /// Returns the coefficients that fit observations, penalties included.
    pub(super) fn coefficients(&self, observed: &[f64]) -> Vec<f64> {
        let Some(factor) = &self.factor else {
            return Vec::new();
        };
        let mut right = Mat::zeros(self.unknowns, 1);
        for (row, observed) in self.rows.iter().zip(observed) {
            for (node, weight) in row {
                if let Some(element) = right.col_as_slice_mut(0).get_mut(*node) {
                    *element += weight * observed;
                }
            }
        }
        let solution = factor.solve(&right);
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

    /// Returns the share of each observation in what is predicted of it.
    ///
    /// # Model
    /// bᵀN⁻¹b, b the row of the design: N⁻¹ by its columns, some at a time.
    pub(super) fn leverages(&self) -> Vec<f64> {
        let mut found = vec![0.0; self.rows.len()];
        let Some(factor) = &self.factor else {
            return found;
        };
        let mut of_node: Vec<Vec<(usize, f64)>> = vec![Vec::new(); self.unknowns];
        for (index, row) in self.rows.iter().enumerate() {
            for (node, weight) in row {
                if let Some(observations) = of_node.get_mut(*node) {
                    observations.push((index, *weight));
                }
            }
        }
        for (block, nodes) in of_node.chunks(COLUMNS).enumerate() {
            let first = block * COLUMNS;
            let unit = Mat::from_fn(self.unknowns, nodes.len(), |line, column| {
                if line == first + column { 1.0 } else { 0.0 }
            });
            let inverse = factor.solve(&unit);
            for (column, observations) in nodes.iter().enumerate() {
                let column = inverse.col_as_slice(column);
                for (index, weight) in observations {
                    let terms = self.rows.get(*index).into_iter().flatten();
                    let terms = terms.filter_map(|(node, other)| Some(other * column.get(*node)?));
                    if let Some(leverage) = found.get_mut(*index) {
                        *leverage += weight * terms.sum::<f64>();
                    }
                }
            }
        }
        found
    }
}
