//! Cofactors (covariances for σ0 = 1) of the unknowns of an adjusted network.

use nalgebra::{DMatrix, Matrix3, Matrix6, Matrix6x3, SMatrix};

use crate::linear::bordered_factor::{BorderedFactor, Singular};
use crate::linear::element::element;
use crate::linear::image_pairs::ImagePairs;

use super::eliminated_point::PointBlock;
use super::layout::{CAMERA_UNKNOWNS, Layout, PointUnknowns};
use super::network::Network;
use super::normals::Normals;
use super::solution::Solution;

/// Most images whose cofactors are computed: six solutions each.
pub const MOST_IMAGES: usize = 5000;

/// Images whose columns of the inverse are solved for at once.
const BATCH: usize = 16;

/// Cofactors of the shared unknowns, and of the images where there are not too many.
///
/// In a free network they belong to the elements that held the datum; [`super::free_cofactors`]
/// transforms them. The border's do not depend on the datum.
#[derive(Debug, Clone)]
pub struct Cofactors {
    /// Of the border, in the order of [`Layout::border`].
    pub border: DMatrix<f64>,
    /// Of the images; `None` for more than [`MOST_IMAGES`].
    pub images: Option<ImageCofactors>,
    factor: BorderedFactor,
}

/// Cofactors of images: blocks of pairs that share a point, and with the border.
#[derive(Debug, Clone)]
pub struct ImageCofactors {
    pairs: ImagePairs,
    blocks: Vec<Matrix6<f64>>,
    /// Cofactors of the border (rows) with the images (six columns each).
    pub with_border: DMatrix<f64>,
}

/// Cofactors of one object point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCofactors {
    /// Of its coordinates, m².
    pub own: Matrix3<f64>,
    /// With the images asked for, in their order.
    pub with_images: Vec<Matrix6x3<f64>>,
    /// With the border (rows).
    pub with_border: DMatrix<f64>,
}

impl Cofactors {
    /// Computes the cofactors of an adjusted network.
    ///
    /// # Errors
    /// [`Singular`] if the observations do not determine the unknowns.
    pub fn of(network: &Network, solution: &Solution) -> Result<Self, Singular> {
        let mut normals = Normals::new(network, &solution.layout, &solution.state, 0.0)?;
        normals.hold(&solution.held);
        let factor = normals.factor(&solution.layout)?;
        let images = (network.images.len() <= MOST_IMAGES)
            .then(|| ImageCofactors::of(&factor, &solution.layout));
        Ok(Self {
            border: factor.border_inverse(),
            images,
            factor,
        })
    }

    /// Factor of the normal matrix from which they were computed.
    #[must_use]
    pub const fn factor(&self) -> &BorderedFactor {
        &self.factor
    }

    /// Cofactors of an object point; `None` for one that is held or not used, or without those of
    /// the images.
    #[must_use]
    pub fn point(
        &self,
        layout: &Layout,
        number: usize,
        block: Option<&PointBlock>,
        wanted: &[usize],
    ) -> Option<PointCofactors> {
        let images = self.images.as_ref()?;
        match (layout.point(number), block) {
            (PointUnknowns::Border(first), _) => Some(PointCofactors {
                own: self.border.fixed_view::<3, 3>(first, first).into_owned(),
                with_images: wanted
                    .iter()
                    .map(|image| {
                        let with = images.with_border.fixed_view::<3, 6>(first, 6 * image);
                        with.transpose()
                    })
                    .collect(),
                with_border: self.border.columns(first, 3).into_owned(),
            }),
            (PointUnknowns::Eliminated, Some(block)) => {
                Some(self.eliminated(images, layout, block, wanted))
            }
            _ => None,
        }
    }

    fn eliminated(
        &self,
        images: &ImageCofactors,
        layout: &Layout,
        block: &PointBlock,
        wanted: &[usize],
    ) -> PointCofactors {
        // dp = V⁻¹(own observations) - Σ Yᵢᵀ·dxᵢ - Y_bᵀ·db.
        let by_images: Vec<(usize, Matrix6x3<f64>)> = block
            .rays
            .iter()
            .map(|ray| (ray.image, PointBlock::with_image(ray) * block.inverse))
            .collect();
        let by_border = expanded(layout, &(block.inverse * block.with_camera));
        let with_image = |image: usize| {
            let mut sum = -(images.with_border.columns(6 * image, 6).tr_mul(&by_border));
            for (other, by_image) in &by_images {
                sum -= images.block(image, *other) * by_image;
            }
            Matrix6x3::from_fn(|row, column| element(&sum, row, column))
        };
        let mut with_border = -(&self.border * &by_border);
        let mut own = block.inverse;
        for (image, by_image) in &by_images {
            with_border -= images.with_border.columns(6 * image, 6) * by_image;
            own -= by_image.tr_mul(&with_image(*image));
        }
        let by_border_part = by_border.tr_mul(&with_border);
        own -= Matrix3::from_fn(|row, column| element(&by_border_part, row, column));
        PointCofactors {
            own,
            with_images: wanted.iter().map(|image| with_image(*image)).collect(),
            with_border,
        }
    }
}

/// Returns coefficients of the camera as columns of the border, transposed.
fn expanded(layout: &Layout, coefficients: &SMatrix<f64, 3, CAMERA_UNKNOWNS>) -> DMatrix<f64> {
    let mut expanded = DMatrix::zeros(layout.border.len(), 3);
    for (column, place) in coefficients.column_iter().zip(layout.camera) {
        if let Some(place) = place {
            expanded.set_row(place, &column.transpose());
        }
    }
    expanded
}

impl ImageCofactors {
    fn of(factor: &BorderedFactor, layout: &Layout) -> Self {
        let pairs = layout.pairs();
        let images = pairs.images();
        let mut blocks = Vec::with_capacity(pairs.blocks());
        let mut with_border = DMatrix::zeros(layout.border.len(), 6 * images);
        let mut first = 0;
        while first < images {
            let count = BATCH.min(images - first);
            let (columns, border) = factor.image_columns(first, count);
            for image in first..first + count {
                let column = 6 * (image - first);
                for row in pairs.column(image) {
                    blocks.push(columns.fixed_view::<6, 6>(6 * row, column).into_owned());
                }
            }
            with_border
                .columns_mut(6 * first, 6 * count)
                .copy_from(&border);
            first += count;
        }
        Self {
            pairs: pairs.clone(),
            blocks,
            with_border,
        }
    }

    /// Cofactors of two images; zero if they share no point.
    #[must_use]
    pub fn block(&self, row: usize, column: usize) -> Matrix6<f64> {
        let of = |row, column| {
            let number = self.pairs.block(row, column)?;
            self.blocks.get(number).copied()
        };
        if row >= column {
            of(row, column).unwrap_or_default()
        } else {
            of(column, row).unwrap_or_default().transpose()
        }
    }
}
