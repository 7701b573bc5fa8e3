//! Access to elements of matrices: an index beyond the matrix reads 0, and is not written.

use nalgebra::{Dim, Matrix, RawStorage, RawStorageMut};

/// Returns an element.
#[must_use]
pub fn element<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
    matrix: &Matrix<f64, R, C, S>,
    row: usize,
    column: usize,
) -> f64 {
    matrix.get((row, column)).copied().unwrap_or(0.0)
}

/// Adds to an element.
pub fn add<R: Dim, C: Dim, S: RawStorageMut<f64, R, C>>(
    matrix: &mut Matrix<f64, R, C, S>,
    row: usize,
    column: usize,
    value: f64,
) {
    if let Some(element) = matrix.get_mut((row, column)) {
        *element += value;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    #[test]
    fn elements_beyond_the_matrix_are_zero() {
        let mut matrix = DMatrix::zeros(2, 1);
        add(&mut matrix, 1, 0, 3.0);
        add(&mut matrix, 2, 0, 4.0);
        let sum: f64 = (0..3).map(|row| element(&matrix, row, 0)).sum();
        assert!((sum - 3.0).abs() < 1e-15);
    }
}
