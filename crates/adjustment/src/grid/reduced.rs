//! Normal equations of the polynomial's coefficients, without the grids, which are eliminated.

use fmc_reference::lens::Lens;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::polynomial::{COEFFICIENTS, derivatives, lens, scales};
use super::smoother::Smoother;

/// Share of the largest eigenvalue of the normal equations below which a combination of
/// coefficients is left as it is, to the grid.
const LEAST_EIGENVALUE: f64 = 1e-13;

/// Share of a coefficient in an undetermined combination from which on it is named.
const LEAST_SHARE: f64 = 0.3;

/// Normal equations of the coefficients that are estimated.
#[derive(Debug)]
pub(super) struct Reduced {
    /// Estimated coefficients, of [`COEFFICIENTS`].
    estimated: Vec<usize>,
    /// Factors from coefficients in units of the radius to those in mm.
    scales: Vec<f64>,
    /// Derivatives by each coefficient less what the grids follow of them, row by row, for x and y.
    left: [Vec<Vec<f64>>; 2],
    /// Cofactors of the coefficients in units of the radius.
    inverse: DMatrix<f64>,
    undetermined: Vec<usize>,
}

impl Reduced {
    /// Returns the normal equations at points from the principal point, mm.
    pub(super) fn new(
        points: &[[f64; 2]],
        is_estimated: [bool; COEFFICIENTS],
        smoother: &Smoother<'_>,
    ) -> Self {
        let estimated: Vec<usize> = (0..COEFFICIENTS)
            .filter(|index| is_estimated.get(*index) == Some(&true))
            .collect();
        let radius_mm = points.iter().map(|[x, y]| x.hypot(*y)).fold(1.0, f64::max);
        let design: Vec<[[f64; 2]; COEFFICIENTS]> = points
            .iter()
            .map(|point| derivatives(*point, radius_mm))
            .collect();
        let of_all = scales(radius_mm);
        let count = estimated.len();
        let mut normal = DMatrix::<f64>::zeros(count, count);
        let left = [0, 1].map(|axis: usize| {
            let values: Vec<Vec<f64>> = estimated
                .iter()
                .map(|index| {
                    let value =
                        |row: &[[f64; 2]; COEFFICIENTS]| row.get(*index)?.get(axis).copied();
                    design.iter().filter_map(value).collect()
                })
                .collect();
            let left: Vec<Vec<f64>> = values.iter().map(|values| smoother.left(values)).collect();
            normal += DMatrix::from_fn(count, count, |row, column| {
                dot(values.get(row), left.get(column))
            });
            left
        });
        let (inverse, undetermined) = inverse(&normal, &estimated);
        Self {
            scales: estimated
                .iter()
                .filter_map(|index| of_all.get(*index).copied())
                .collect(),
            estimated,
            left,
            inverse,
            undetermined,
        }
    }

    /// Returns the change of the polynomial that leaves the least of observations, mm.
    pub(super) fn change(&self, observed: &[[f64; 2]]) -> Lens {
        let right = DVector::from_fn(self.estimated.len(), |index, _| {
            let of_axis = |left: &[Vec<f64>], component: fn(&[f64; 2]) -> f64| {
                let left = left.get(index).into_iter().flatten();
                let pairs = left.zip(observed);
                pairs.map(|(a, pair)| a * component(pair)).sum::<f64>()
            };
            let [x, y] = &self.left;
            of_axis(x, |[x, _]| *x) + of_axis(y, |[_, y]| *y)
        });
        let solution = &self.inverse * right;
        let mut coefficients = [0.0; COEFFICIENTS];
        for ((index, scale), value) in self.estimated.iter().zip(&self.scales).zip(solution.iter())
        {
            if let Some(coefficient) = coefficients.get_mut(*index) {
                *coefficient = value / scale;
            }
        }
        lens(coefficients)
    }

    /// Returns the cofactors of the estimated coefficients in mm, for observations of 1 mm.
    pub(super) fn cofactors(&self) -> DMatrix<f64> {
        let mut cofactors = self.inverse.clone();
        for (mut row, scale) in cofactors.row_iter_mut().zip(&self.scales) {
            row /= *scale;
        }
        for (mut column, scale) in cofactors.column_iter_mut().zip(&self.scales) {
            column /= *scale;
        }
        cofactors
    }

    /// Returns the part of the leverage of each row, x and y, that the polynomial adds to that of
    /// the grids.
    pub(super) fn leverages(&self) -> Vec<[f64; 2]> {
        let [of_x, of_y] = [0, 1].map(|axis: usize| {
            let left = self.left.get(axis).map_or(&[][..], Vec::as_slice);
            let rows = left.first().map_or(0, Vec::len);
            let of_row = |row: usize| {
                let values = left.iter().filter_map(|one| one.get(row).copied());
                let values = DVector::from_iterator(left.len(), values);
                (&self.inverse * &values).dot(&values)
            };
            (0..rows).map(of_row).collect::<Vec<f64>>()
        });
        of_x.into_iter().zip(of_y).map(|(x, y)| [x, y]).collect()
    }

    /// Coefficients that the grids follow wholly: they are left as they were.
    pub(super) fn undetermined(&self) -> &[usize] {
        &self.undetermined
    }
}

/// Returns the inverse of normal equations without combinations that they do not determine, and the
/// coefficients of those.
fn inverse(normal: &DMatrix<f64>, estimated: &[usize]) -> (DMatrix<f64>, Vec<usize>) {
    if normal.is_empty() {
        return (normal.clone(), Vec::new());
    }
    let symmetric = 0.5 * (normal + normal.transpose());
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = symmetric.symmetric_eigen();
    let least = eigenvalues.amax() * LEAST_EIGENVALUE;
    let mut inverse = DMatrix::zeros(normal.nrows(), normal.ncols());
    let mut undetermined = Vec::new();
    for (vector, value) in eigenvectors.column_iter().zip(eigenvalues.iter()) {
        if *value > least {
            inverse += vector * vector.transpose() / *value;
        } else {
            let large = estimated.iter().zip(vector.iter());
            let large = large.filter(|(_, share)| share.abs() > LEAST_SHARE);
            undetermined.extend(large.map(|(index, _)| *index));
        }
    }
    undetermined.sort_unstable();
    undetermined.dedup();
    (inverse, undetermined)
}

fn dot(a: Option<&Vec<f64>>, b: Option<&Vec<f64>>) -> f64 {
    let pairs = a.into_iter().flatten().zip(b.into_iter().flatten());
    pairs.map(|(a, b)| a * b).sum()
}
