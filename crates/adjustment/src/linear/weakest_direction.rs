//! Combination of unknowns that a normal matrix determines least.

use nalgebra::DMatrix;

use super::bordered_factor::{BorderedFactor, EliminationOrder, Singular};
use super::bordered_matrix::BorderedMatrix;

/// Additions to the unit diagonal that make a singular matrix one that can be factored; elimination
/// of points has cost some of its digits, so the first may not do.
const REGULARISATIONS: [f64; 3] = [1e-11, 1e-9, 1e-7];

/// Steps of inverse iteration; each multiplies the share of a direction by the ratio of the least
/// eigenvalue to its own.
const STEPS: usize = 12;

/// Smallest eigenvalue of a matrix scaled to a unit diagonal, and its eigenvector.
#[derive(Debug, Clone, PartialEq)]
pub struct WeakestDirection {
    /// Eigenvalue; a singular matrix has one of less than 1e-12, due to rounding.
    pub eigenvalue: f64,
    /// Components of the eigenvector, images first, for the scaled unknowns.
    pub components: Vec<f64>,
}

impl WeakestDirection {
    /// Finds the direction by inverse iteration of the slightly regularised matrix.
    ///
    /// # Errors
    /// [`Singular`] if an unknown is not observed at all.
    pub fn new(matrix: &BorderedMatrix, order: &EliminationOrder) -> Result<Self, Singular> {
        let (factor, regularisation) = REGULARISATIONS
            .into_iter()
            .find_map(|addition| {
                let factor = BorderedFactor::new(matrix, order, addition).ok()?;
                Some((factor, addition))
            })
            .ok_or(Singular)?;
        let rows = matrix.border.nrows();
        // A start that no regular network makes orthogonal to the eigenvector.
        let start = |index: usize| {
            let bits = u16::try_from((index * 7919 + 104_729) % 2048).unwrap_or(0);
            0.5 + f64::from(bits) / 2048.0
        };
        let mut images = DMatrix::from_fn(rows, 1, |row, _| start(row));
        let mut border = DMatrix::from_fn(matrix.corner.nrows(), 1, |row, _| start(rows + row));
        let mut growth = 1.0;
        for _ in 0..STEPS {
            let before = images.norm_squared() + border.norm_squared();
            let scale = 1.0 / before.sqrt();
            images *= scale;
            border *= scale;
            factor.solve_scaled(&mut images, &mut border);
            growth = (images.norm_squared() + border.norm_squared()).sqrt();
        }
        if !growth.is_finite() || growth <= 0.0 {
            return Err(Singular);
        }
        Ok(Self {
            eigenvalue: 1.0 / growth - regularisation,
            components: images
                .iter()
                .chain(border.iter())
                .map(|component| component / growth)
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix6;

    use super::*;
    use crate::linear::image_pairs::ImagePairs;

    #[test]
    fn direction_is_the_null_vector() {
        let mut matrix = BorderedMatrix::zeros(ImagePairs::new(1, &[]), 1);
        matrix.add_block(0, 0, &(4.0 * Matrix6::identity()));
        // The shared unknown does the same as the third unknown of the image.
        matrix.border[(2, 0)] = 6.0;
        matrix.corner[(0, 0)] = 9.0;
        let order = EliminationOrder::new(matrix.pairs()).unwrap();
        let weakest = WeakestDirection::new(&matrix, &order).unwrap();
        assert!(weakest.eigenvalue.abs() < 1e-12);
        let [.., third, _, _, _, shared] = weakest.components[..] else {
            panic!("seven components")
        };
        assert!((third + shared).abs() < 1e-6 && (third.abs() - 0.5_f64.sqrt()).abs() < 1e-6);
    }
}
