//! Normal equations of a strip: six unknowns per frame and five that all frames share.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use crate::correction::COEFFICIENTS;
use crate::exterior_orientation::ELEMENTS;

pub(super) type FrameMatrix = SMatrix<f64, ELEMENTS, ELEMENTS>;
pub(super) type FrameVector = SVector<f64, ELEMENTS>;
pub(super) type Coupling = SMatrix<f64, ELEMENTS, COEFFICIENTS>;
pub(super) type SharedMatrix = SMatrix<f64, COEFFICIENTS, COEFFICIENTS>;
pub(super) type SharedVector = SVector<f64, COEFFICIENTS>;

/// Part of one frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FrameBlock {
    /// Matrix of the exterior orientation.
    pub(super) matrix: FrameMatrix,
    /// Coupling of exterior orientation and coefficients.
    pub(super) coupling: Coupling,
    /// Right-hand side.
    pub(super) right: FrameVector,
}

/// The normal equations.
#[derive(Debug, Clone, Default)]
pub(super) struct NormalEquations {
    pub(super) frames: Vec<FrameBlock>,
    /// Matrix of the coefficients, with unit rows for those that are not estimated.
    pub(super) shared: SharedMatrix,
    pub(super) shared_right: SharedVector,
}

/// Solution with the cofactors of its parts.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub(super) frames: Vec<FrameVector>,
    pub(super) shared: SharedVector,
}

/// Inverses of the diagonal blocks of the normal matrix.
#[derive(Debug, Clone)]
pub(super) struct Cofactors {
    pub(super) frames: Vec<FrameMatrix>,
    pub(super) shared: SharedMatrix,
}

impl NormalEquations {
    /// Solves with the diagonal enlarged by the factor 1 + `damping`; `None` if the matrix is not
    /// positive definite.
    pub(super) fn solve(&self, damping: f64) -> Option<Solution> {
        let mut reduced = damped(&self.shared, damping);
        let mut right = self.shared_right;
        let mut factors = Vec::with_capacity(self.frames.len());
        for block in &self.frames {
            let factor = Factor::new(&damped(&block.matrix, damping))?;
            reduced -= block.coupling.tr_mul(&factor.solve(&block.coupling));
            right -= block.coupling.tr_mul(&factor.solve(&block.right));
            factors.push(factor);
        }
        let shared = Factor::new(&reduced)?.solve(&right);
        let frames = self
            .frames
            .iter()
            .zip(&factors)
            .map(|(block, factor)| factor.solve(&(block.right - block.coupling * shared)))
            .collect();
        Some(Solution { frames, shared })
    }

    /// Returns the cofactors of the unknowns: their covariance for a standard deviation of unit
    /// weight of 1.
    pub(super) fn cofactors(&self) -> Option<Cofactors> {
        let reduced = Factor::new(&self.reduced()?)?;
        let shared = reduced.solve(&SharedMatrix::identity());
        let frames = self
            .frames
            .iter()
            .map(|block| {
                let factor = Factor::new(&block.matrix)?;
                let transfer = factor.solve(&block.coupling);
                let own = factor.solve(&FrameMatrix::identity());
                Some(own + transfer * shared * transfer.transpose())
            })
            .collect::<Option<_>>()?;
        Some(Cofactors { frames, shared })
    }

    /// Returns the matrix of the coefficients after elimination of the frames (Schur complement).
    pub(super) fn reduced(&self) -> Option<SharedMatrix> {
        let mut reduced = self.shared;
        for block in &self.frames {
            let factor = Factor::new(&block.matrix)?;
            reduced -= block.coupling.tr_mul(&factor.solve(&block.coupling));
        }
        Some(reduced)
    }
}

/// Cholesky factor of a matrix scaled to a unit diagonal, because metres and radians mix.
#[derive(Debug, Clone)]
pub(super) struct Factor<const N: usize> {
    scale: SVector<f64, N>,
    factor: Cholesky<f64, Const<N>>,
}

impl<const N: usize> Factor<N> {
    pub(super) fn new(matrix: &SMatrix<f64, N, N>) -> Option<Self> {
        let (scale, scaled) = unit_diagonal(matrix)?;
        Some(Self {
            scale,
            factor: Cholesky::new(scaled)?,
        })
    }

    pub(super) fn solve<const M: usize>(&self, right: &SMatrix<f64, N, M>) -> SMatrix<f64, N, M> {
        let scale = SMatrix::from_diagonal(&self.scale);
        scale * self.factor.solve(&(scale * right))
    }
}

/// Returns the matrix scaled to a unit diagonal and the factors of its rows and columns; `None` for
/// a diagonal that is not positive.
pub(super) fn unit_diagonal<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
) -> Option<(SVector<f64, N>, SMatrix<f64, N, N>)> {
    let diagonal = matrix.diagonal();
    if !diagonal.iter().all(|element| *element > 0.0) {
        return None;
    }
    let scale = diagonal.map(|element| element.sqrt().recip());
    let scaling = SMatrix::from_diagonal(&scale);
    Some((scale, scaling * matrix * scaling))
}

fn damped<const N: usize>(matrix: &SMatrix<f64, N, N>, damping: f64) -> SMatrix<f64, N, N> {
    matrix + SMatrix::from_diagonal(&(damping * matrix.diagonal()))
}
