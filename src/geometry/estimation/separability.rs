//! Separability: the parameters that a design can tell apart.

use nalgebra::SMatrix;

use super::number::Number;
use super::parameter::PARAMETERS;
use super::triangle::{Triangle, at, put, zeros};

/// Sweeps of rotations over all pairs of columns; six columns are orthogonal to rounding after
/// five or six.
const SWEEPS: usize = 10;

/// Smallest and largest singular value of a design with columns of unit length, and the direction
/// that the smallest belongs to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Separability<T> {
    pub(super) least: T,
    pub(super) most: T,
    /// Share of each unknown in the combination that the design determines worst.
    pub(super) direction: [T; PARAMETERS],
    /// The first column without a length.
    pub(super) empty: Option<usize>,
}

impl<T: Number> Separability<T> {
    /// Computes it for the first `size` columns of a factor by one-sided Jacobi rotations (Golub
    /// and Van Loan, Matrix Computations, 4th ed., section 8.6.3): RV = UΣ.
    pub(super) fn of<const N: usize>(triangle: &Triangle<T, N>, size: usize) -> Self {
        let size = size.min(PARAMETERS);
        let mut columns: SMatrix<T, PARAMETERS, PARAMETERS> = zeros();
        let mut directions: SMatrix<T, PARAMETERS, PARAMETERS> = zeros();
        let mut empty = None;
        for column in 0..size {
            let squares = (0..size).fold(T::ZERO, |sum, row| {
                sum + triangle.at(row, column) * triangle.at(row, column)
            });
            let length = squares.sqrt();
            if length > T::ZERO {
                for row in 0..size {
                    put(&mut columns, row, column, triangle.at(row, column) / length);
                }
            } else if empty.is_none() {
                empty = Some(column);
            }
            put(&mut directions, column, column, T::ONE);
        }
        for _ in 0..SWEEPS {
            for first in 0..size {
                for second in first + 1..size {
                    if let Some(rotation) = orthogonalising(&columns, first, second) {
                        rotate(&mut columns, first, second, rotation);
                        rotate(&mut directions, first, second, rotation);
                    }
                }
            }
        }
        let mut result = Self {
            least: T::ONE,
            most: T::ZERO,
            direction: [T::ZERO; PARAMETERS],
            empty,
        };
        let mut weakest = None;
        for column in 0..size {
            let value = product(&columns, column, column).sqrt();
            if value > result.most {
                result.most = value;
            }
            if weakest.is_none() || value < result.least {
                result.least = value;
                weakest = Some(column);
            }
        }
        for (row, share) in result.direction.iter_mut().enumerate() {
            *share = weakest.map_or(T::ZERO, |column| at(&directions, row, column));
        }
        result
    }
}

fn product<T: Number, const N: usize>(
    columns: &SMatrix<T, N, N>,
    first: usize,
    second: usize,
) -> T {
    (0..N).fold(T::ZERO, |sum, row| {
        sum + at(columns, row, first) * at(columns, row, second)
    })
}

/// Returns cosine and sine of the rotation that makes two columns orthogonal, or `None` if they are
/// orthogonal.
fn orthogonalising<T: Number, const N: usize>(
    columns: &SMatrix<T, N, N>,
    first: usize,
    second: usize,
) -> Option<(T, T)> {
    let mixed = product(columns, first, second);
    if mixed.abs() <= T::ZERO {
        return None;
    }
    let two = T::of(2.0);
    let zeta = (product(columns, second, second) - product(columns, first, first)) / (two * mixed);
    let root = (T::ONE + zeta * zeta).sqrt();
    let tangent = if zeta >= T::ZERO {
        T::ONE / (zeta + root)
    } else {
        T::ONE / (zeta - root)
    };
    let cosine = T::ONE / (T::ONE + tangent * tangent).sqrt();
    Some((cosine, cosine * tangent))
}

fn rotate<T: Number, const N: usize>(
    matrix: &mut SMatrix<T, N, N>,
    first: usize,
    second: usize,
    (cosine, sine): (T, T),
) {
    for row in 0..N {
        let (a, b) = (at(matrix, row, first), at(matrix, row, second));
        put(matrix, row, first, cosine * a - sine * b);
        put(matrix, row, second, sine * a + cosine * b);
    }
}
