//! Cofactors of images and points of a free network: the transformation into the datum of inner
//! constraints.

use nalgebra::{DMatrix, Matrix3, Matrix3xX, Matrix6, Vector3};

use super::cofactors::Cofactors;
use super::datum::Datum;
use super::eliminated_point::PointBlock;
use super::layout::PointUnknowns;
use super::network::Network;
use super::solution::Solution;
use super::state::State;

/// Transformation of cofactors `Q → S·Q·Sᵀ`, `S = I - H(GᵀH)⁻¹Gᵀ` (Baarda 1973): H the derivatives
/// of all unknowns by the free combinations, G those of the object points alone.
#[derive(Debug, Clone)]
pub struct DatumTransformation {
    datum: Datum,
    /// `(GᵀH)⁻¹`.
    inverse: DMatrix<f64>,
    /// `Q·G` of the images, six rows each.
    images: DMatrix<f64>,
    /// `Q·G` of the object points, zero for those without unknowns.
    points: Vec<Matrix3xX<f64>>,
    /// `GᵀQG`.
    middle: DMatrix<f64>,
}

impl DatumTransformation {
    /// Prepares the transformation; `None` where the datum has no defect or G is singular.
    #[must_use]
    pub fn new(network: &Network, solution: &Solution, cofactors: &Cofactors) -> Option<Self> {
        let datum = solution.datum.clone();
        let (layout, state) = (&solution.layout, &solution.state);
        let defects = datum.defects();
        if defects == 0 {
            return None;
        }
        let of_point = |number: usize| -> Matrix3xX<f64> {
            if State::is_unknown(layout, number) {
                datum.of_point(&state.point(number)) * &datum.free
            } else {
                Matrix3xX::zeros(defects)
            }
        };
        let mut images = DMatrix::zeros(6 * network.images.len(), defects);
        let mut border = DMatrix::zeros(layout.border.len(), defects);
        let blocks: Vec<Option<PointBlock>> = point_blocks(network, solution);
        let mut gram = DMatrix::zeros(defects, defects);
        for (number, block) in blocks.iter().enumerate() {
            let own = of_point(number);
            gram += own.tr_mul(&own);
            if let PointUnknowns::Border(first) = layout.point(number) {
                border.rows_mut(first, 3).copy_from(&own);
            }
            let Some(block) = block else { continue };
            let projected = block.inverse * &own;
            for ray in &block.rays {
                let mut rows = images.rows_mut(6 * ray.image, 6);
                rows -= PointBlock::with_image(ray) * &projected;
            }
            let camera = block.with_camera.transpose() * &projected;
            for (row, place) in layout.camera.iter().enumerate() {
                if let Some(place) = place {
                    let mut target = border.row_mut(*place);
                    target -= camera.row(row);
                }
            }
        }
        cofactors.factor().solve(&mut images, &mut border);
        let mut middle = DMatrix::zeros(defects, defects);
        let points: Vec<Matrix3xX<f64>> = blocks
            .iter()
            .enumerate()
            .map(|(number, block)| {
                let own = of_point(number);
                let solved = match (layout.point(number), block) {
                    (PointUnknowns::Border(first), _) => border.fixed_rows::<3>(first).into_owned(),
                    (_, Some(block)) => {
                        let mut right = own.clone();
                        for ray in &block.rays {
                            let rows = images.rows(6 * ray.image, 6);
                            right -= PointBlock::with_image(ray).transpose() * rows;
                        }
                        for (column, place) in layout.camera.iter().enumerate() {
                            if let Some(place) = place {
                                right -= block.with_camera.column(column) * border.row(*place);
                            }
                        }
                        block.inverse * right
                    }
                    _ => Matrix3xX::zeros(defects),
                };
                middle += own.tr_mul(&solved);
                solved
            })
            .collect();
        Some(Self {
            inverse: gram.try_inverse()?,
            datum,
            images,
            points,
            middle,
        })
    }

    /// Transforms the cofactors of an image.
    #[must_use]
    pub fn image(&self, solution: &Solution, number: usize, own: &Matrix6<f64>) -> Matrix6<f64> {
        let Some(pose) = solution.state.poses.get(number) else {
            return *own;
        };
        let by_free = self.datum.of_pose(pose) * &self.datum.free * &self.inverse;
        let cross = &by_free * self.images.rows(6 * number, 6).transpose();
        let transformed =
            DMatrix::from_column_slice(6, 6, own.as_slice()) - &cross - cross.transpose()
                + &by_free * &self.middle * by_free.transpose();
        Matrix6::from_column_slice(transformed.as_slice())
    }

    /// Transforms the cofactors of an object point.
    #[must_use]
    pub fn point(&self, point_m: &Vector3<f64>, number: usize, own: &Matrix3<f64>) -> Matrix3<f64> {
        let Some(solved) = self.points.get(number) else {
            return *own;
        };
        let by_free = self.datum.of_point(point_m) * &self.datum.free * &self.inverse;
        let cross = &by_free * solved.transpose();
        let transformed =
            own - cross.transpose() - cross + &by_free * &self.middle * by_free.transpose();
        Matrix3::from_column_slice(transformed.as_slice())
    }
}

/// Returns the normal equations of the eliminated points, by their number.
#[must_use]
pub fn point_blocks(network: &Network, solution: &Solution) -> Vec<Option<PointBlock>> {
    let mut blocks = vec![None; network.points.len()];
    for observed in network.by_point() {
        let number = observed.first().map_or(0, |ray| ray.point);
        if solution.layout.point(number) == PointUnknowns::Eliminated
            && let Some(place) = blocks.get_mut(number)
        {
            *place = PointBlock::new(network, &solution.layout, &solution.state, observed, 0.0);
        }
    }
    blocks
}
