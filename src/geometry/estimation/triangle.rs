//! The triangular factor of a design, updated row by row.

use nalgebra::{ArrayStorage, SMatrix};

use super::number::Number;

/// A matrix of zeros.
pub(super) fn zeros<T: Number, const N: usize>() -> SMatrix<T, N, N> {
    SMatrix::from_array_storage(ArrayStorage([[T::ZERO; N]; N]))
}

/// Returns an element, or zero for an index out of range, which no caller gives: without a panic.
pub(super) fn at<T: Number, const N: usize>(
    matrix: &SMatrix<T, N, N>,
    row: usize,
    column: usize,
) -> T {
    matrix.get((row, column)).copied().unwrap_or(T::ZERO)
}

/// Replaces an element.
pub(super) fn put<T: Number, const N: usize>(
    matrix: &mut SMatrix<T, N, N>,
    row: usize,
    column: usize,
    value: T,
) {
    if let Some(element) = matrix.get_mut((row, column)) {
        *element = value;
    }
}

/// R of a QR decomposition without Q: `RᵀR = AᵀA` of all rows absorbed, never formed itself.
///
/// With the right-hand side as last column, the last diagonal element is the root of the sum of
/// squared residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Triangle<T: Number, const N: usize> {
    r: SMatrix<T, N, N>,
}

impl<T: Number, const N: usize> Triangle<T, N> {
    /// Returns the factor of no rows.
    pub(super) fn empty() -> Self {
        Self { r: zeros() }
    }

    /// The element R\[row, column\].
    pub(super) fn at(&self, row: usize, column: usize) -> T {
        at(&self.r, row, column)
    }

    /// Takes a row into R by one Givens rotation per column: Golub and Van Loan, Matrix
    /// Computations, 4th ed., sections 5.1.8 and 6.5.3.
    pub(super) fn absorb(&mut self, mut row: [T; N]) {
        for pivot in 0..N {
            let top = self.at(pivot, pivot);
            let low = row.get(pivot).copied().unwrap_or(T::ZERO);
            let length = (top * top + low * low).sqrt();
            // A column without length needs no rotation.
            if length > T::ZERO {
                let (cos, sin) = (top / length, low / length);
                for (column, low) in row.iter_mut().enumerate().skip(pivot) {
                    let top = self.at(pivot, column);
                    put(&mut self.r, pivot, column, cos * top + sin * *low);
                    *low = cos * *low - sin * top;
                }
            }
        }
    }

    /// Takes all rows of another factor.
    pub(super) fn absorb_triangle(&mut self, other: &Self) {
        for row in 0..N {
            self.absorb(other.row(row));
        }
    }

    /// Returns a row, including its zeros.
    pub(super) fn row(&self, row: usize) -> [T; N] {
        let mut elements = [T::ZERO; N];
        for (column, element) in elements.iter_mut().enumerate() {
            *element = self.at(row, column);
        }
        elements
    }

    /// Returns R⁻¹ of the first `size` columns, and zeros beyond them. The diagonal must not hold
    /// zeros.
    pub(super) fn inverse(&self, size: usize) -> SMatrix<T, N, N> {
        let mut inverse = zeros();
        for column in 0..size.min(N) {
            for row in (0..=column).rev() {
                let unit = if row == column { T::ONE } else { T::ZERO };
                let known = (row + 1..=column).fold(T::ZERO, |sum, inner| {
                    sum + self.at(row, inner) * at(&inverse, inner, column)
                });
                put(
                    &mut inverse,
                    row,
                    column,
                    (unit - known) / self.at(row, row),
                );
            }
        }
        inverse
    }
}
