//! Cholesky factor of a bordered matrix: sparse for the images, dense for the border.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Side};
use nalgebra::{Cholesky, DMatrix, DMatrixView, Dyn};

use super::bordered_matrix::{BorderedMatrix, IMAGE_UNKNOWNS};
use super::image_pairs::ImagePairs;
use crate::linear::element::{add, element};

/// Error: a matrix is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the normal matrix is singular")]
pub struct Singular;

/// Order of elimination of the images and places of the elements of the factor: found once, used in
/// every iteration.
#[derive(Debug, Clone)]
pub struct EliminationOrder {
    structure: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLlt<usize>,
}

impl EliminationOrder {
    /// Finds the order for the pairs of images.
    ///
    /// # Errors
    /// [`Singular`] if the matrix does not fit into memory.
    pub fn new(pairs: &ImagePairs) -> Result<Self, Singular> {
        let columns = IMAGE_UNKNOWNS * pairs.images();
        let mut starts = vec![0];
        let mut rows = Vec::new();
        for image in 0..pairs.images() {
            for column in 0..IMAGE_UNKNOWNS {
                for &other in pairs.column(image) {
                    let first = if other == image { column } else { 0 };
                    rows.extend((first..IMAGE_UNKNOWNS).map(|row| IMAGE_UNKNOWNS * other + row));
                }
                starts.push(rows.len());
            }
        }
        let structure = SymbolicSparseColMat::new_checked(columns, columns, starts, None, rows);
        let symbolic =
            SymbolicLlt::try_new(structure.as_ref(), Side::Lower).map_err(|_| Singular)?;
        Ok(Self {
            structure,
            symbolic,
        })
    }

    fn structure(&self) -> SymbolicSparseColMatRef<'_, usize> {
        self.structure.as_ref()
    }
}

/// Factor of a bordered matrix that was scaled to a unit diagonal.
#[derive(Debug, Clone)]
pub struct BorderedFactor {
    /// One over the root of the diagonal, images first.
    scales: Vec<f64>,
    images: Option<Llt<usize, f64>>,
    /// R⁻¹E, scaled.
    eliminated: DMatrix<f64>,
    /// Of F - EᵀR⁻¹E, scaled.
    corner: Cholesky<f64, Dyn>,
    /// E, scaled.
    border: DMatrix<f64>,
}

impl BorderedFactor {
    /// Factors a matrix, its unit diagonal enlarged by `damping`.
    ///
    /// # Errors
    /// [`Singular`] if the matrix is not positive definite.
    pub fn new(
        matrix: &BorderedMatrix,
        order: &EliminationOrder,
        damping: f64,
    ) -> Result<Self, Singular> {
        let scales: Vec<f64> = matrix
            .diagonal()
            .into_iter()
            .map(|element| {
                let scale = 1.0 / element.sqrt();
                (element > 0.0 && scale.is_finite()).then_some(scale)
            })
            .collect::<Option<_>>()
            .ok_or(Singular)?;
        let rows = matrix.border.nrows();
        let (image_scales, border_scales) = scales.split_at_checked(rows).ok_or(Singular)?;
        let values = scaled_values(matrix, image_scales, damping);
        let images = (rows > 0)
            .then(|| {
                let sparse = SparseColMatRef::new(order.structure(), &values);
                Llt::try_new_with_symbolic(order.symbolic.clone(), sparse, Side::Lower)
            })
            .transpose()
            .map_err(|_| Singular)?;
        let mut border = matrix.border.clone();
        for (mut column, scale) in border.column_iter_mut().zip(border_scales) {
            for (element, own) in column.iter_mut().zip(image_scales) {
                *element *= scale * own;
            }
        }
        let mut eliminated = border.clone();
        solve_images(images.as_ref(), &mut eliminated);
        let mut corner = matrix.corner.clone();
        for (index, scale) in border_scales.iter().enumerate() {
            corner.column_mut(index).scale_mut(*scale);
            corner.row_mut(index).scale_mut(*scale);
        }
        corner -= border.tr_mul(&eliminated);
        for index in 0..corner.nrows() {
            add(&mut corner, index, index, damping);
        }
        let corner = Cholesky::new(corner).ok_or(Singular)?;
        Ok(Self {
            scales,
            images,
            eliminated,
            corner,
            border,
        })
    }

    /// Solves for several right-hand sides, one in each column: those of the images in `images`,
    /// those of the border in `border`.
    pub fn solve(&self, images: &mut DMatrix<f64>, border: &mut DMatrix<f64>) {
        self.scale(images, border);
        self.solve_scaled(images, border);
        self.scale(images, border);
    }

    /// As [`Self::solve`], with the matrix scaled to a unit diagonal.
    pub fn solve_scaled(&self, images: &mut DMatrix<f64>, border: &mut DMatrix<f64>) {
        *border -= self.eliminated.tr_mul(images);
        self.corner.solve_mut(border);
        *images -= &self.border * &*border;
        solve_images(self.images.as_ref(), images);
    }

    /// Multiplies by one over the roots of the diagonal.
    pub fn scale(&self, images: &mut DMatrix<f64>, border: &mut DMatrix<f64>) {
        let (own, shared) = self
            .scales
            .split_at_checked(images.nrows())
            .unwrap_or((&[], &[]));
        for mut column in images.column_iter_mut() {
            column
                .iter_mut()
                .zip(own)
                .for_each(|(x, scale)| *x *= scale);
        }
        for mut column in border.column_iter_mut() {
            column
                .iter_mut()
                .zip(shared)
                .for_each(|(x, scale)| *x *= scale);
        }
    }

    /// One over the roots of the diagonal, images first.
    #[must_use]
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Returns the part of the inverse that belongs to the border.
    #[must_use]
    pub fn border_inverse(&self) -> DMatrix<f64> {
        let mut inverse = self.corner.inverse();
        let shared = self.scales.iter().skip(self.border.nrows());
        for (index, scale) in shared.enumerate() {
            inverse.column_mut(index).scale_mut(*scale);
            inverse.row_mut(index).scale_mut(*scale);
        }
        inverse
    }

    /// Returns the columns of the inverse that belong to images `first..first + count`: the part of
    /// the images, and that of the border.
    #[must_use]
    pub fn image_columns(&self, first: usize, count: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let rows = self.border.nrows();
        let columns = IMAGE_UNKNOWNS * count;
        let mut images = DMatrix::zeros(rows, columns);
        let mut border = DMatrix::zeros(self.border.ncols(), columns);
        for column in 0..columns {
            if let Some(element) = images.get_mut((IMAGE_UNKNOWNS * first + column, column)) {
                *element = 1.0;
            }
        }
        self.solve(&mut images, &mut border);
        (images, border)
    }
}

fn solve_images(factor: Option<&Llt<usize, f64>>, right: &mut DMatrix<f64>) {
    let (rows, columns) = right.shape();
    if let Some(factor) = factor
        && columns > 0
    {
        let right = MatMut::from_column_major_slice_mut(right.as_mut_slice(), rows, columns);
        factor.solve_in_place_with_conj(Conj::No, right);
    }
}

/// Returns the lower triangle of the images' matrix by columns, scaled to a unit diagonal.
fn scaled_values(matrix: &BorderedMatrix, scales: &[f64], damping: f64) -> Vec<f64> {
    let scale = |image: usize| -> DMatrixView<'_, f64> {
        let start = IMAGE_UNKNOWNS * image;
        let part = scales
            .get(start..start + IMAGE_UNKNOWNS)
            .unwrap_or(&[0.0; IMAGE_UNKNOWNS]);
        DMatrixView::from_slice(part, IMAGE_UNKNOWNS, 1)
    };
    let mut values = Vec::new();
    for image in 0..matrix.pairs().images() {
        let own = scale(image);
        for column in 0..IMAGE_UNKNOWNS {
            let others = matrix
                .pairs()
                .column(image)
                .iter()
                .zip(matrix.column(image));
            for (&other, block) in others {
                let rows = scale(other);
                let first = if other == image { column } else { 0 };
                for row in first..IMAGE_UNKNOWNS {
                    let value = element(block, row, column)
                        * element(&rows, row, 0)
                        * element(&own, column, 0);
                    let on_diagonal = other == image && row == column;
                    values.push(if on_diagonal { value + damping } else { value });
                }
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix6;

    use super::*;

    /// Returns a positive definite matrix of three images and two shared unknowns, and the same as
    /// a dense one.
    fn example() -> (BorderedMatrix, DMatrix<f64>) {
        let mut matrix = BorderedMatrix::zeros(ImagePairs::new(3, &[&[0, 2], &[1, 2]]), 2);
        let wave =
            |a: usize, b: usize| f64::from(u8::try_from((7 * a + 3 * b) % 11).unwrap()) - 5.0;
        for (row, column) in [(2, 0), (2, 1)] {
            matrix.add_block(
                row,
                column,
                &Matrix6::from_fn(|i, j| wave(i + row, j + column)),
            );
        }
        for image in 0..3 {
            matrix.add_block(
                image,
                image,
                &(Matrix6::identity() * (90.0 + wave(image, 2))),
            );
        }
        matrix.border = DMatrix::from_fn(18, 2, wave);
        matrix.corner = DMatrix::identity(2, 2) * 120.0;
        let mut dense = DMatrix::zeros(20, 20);
        for column in 0..3 {
            let rows = matrix.pairs().column(column).to_vec();
            for (row, block) in rows.into_iter().zip(matrix.column(column)) {
                dense
                    .view_mut((6 * row, 6 * column), (6, 6))
                    .copy_from(block);
                dense
                    .view_mut((6 * column, 6 * row), (6, 6))
                    .copy_from(&block.transpose());
            }
        }
        dense.view_mut((0, 18), (18, 2)).copy_from(&matrix.border);
        dense
            .view_mut((18, 0), (2, 18))
            .copy_from(&matrix.border.transpose());
        dense.view_mut((18, 18), (2, 2)).copy_from(&matrix.corner);
        (matrix, dense)
    }

    #[test]
    fn solution_and_inverse_are_those_of_the_dense_matrix() {
        let (matrix, dense) = example();
        let order = EliminationOrder::new(matrix.pairs()).unwrap();
        let factor = BorderedFactor::new(&matrix, &order, 0.0).unwrap();
        let inverse = dense.clone().try_inverse().unwrap();
        let (images, border) = factor.image_columns(1, 2);
        assert!((images - inverse.view((0, 6), (18, 12))).amax() < 1e-14);
        assert!((border - inverse.view((18, 6), (2, 12))).amax() < 1e-14);
        assert!((factor.border_inverse() - inverse.view((18, 18), (2, 2))).amax() < 1e-14);
        let mut images = DMatrix::from_fn(18, 1, |i, _| f64::from(u8::try_from(i).unwrap()));
        let mut border = DMatrix::from_element(2, 1, 3.0);
        let right = DMatrix::from_fn(20, 1, |i, _| if i < 18 { images[(i, 0)] } else { 3.0 });
        factor.solve(&mut images, &mut border);
        let expected = inverse * right;
        assert!((images - expected.rows(0, 18)).amax() < 1e-13);
        assert!((border - expected.rows(18, 2)).amax() < 1e-13);
    }

    #[test]
    fn singular_matrix_is_refused() {
        let (mut matrix, _) = example();
        matrix.add_to_diagonal(1, 3, -1000.0);
        let order = EliminationOrder::new(matrix.pairs()).unwrap();
        assert_eq!(
            BorderedFactor::new(&matrix, &order, 0.0).unwrap_err(),
            Singular
        );
    }

    #[test]
    fn border_alone_is_solved() {
        let mut matrix = BorderedMatrix::zeros(ImagePairs::new(0, &[]), 1);
        matrix.corner[(0, 0)] = 4.0;
        let order = EliminationOrder::new(matrix.pairs()).unwrap();
        let factor = BorderedFactor::new(&matrix, &order, 0.0).unwrap();
        assert!((factor.border_inverse()[(0, 0)] - 0.25).abs() < 1e-15);
    }
}
