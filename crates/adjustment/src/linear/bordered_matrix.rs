//! Normal matrix of images, sparse in blocks, bordered by the unknowns that they share.

use nalgebra::{DMatrix, Matrix6};

use super::image_pairs::ImagePairs;

/// Unknowns of an image.
pub const IMAGE_UNKNOWNS: usize = 6;

/// Symmetric matrix `[R E; Eᵀ F]`: R sparse in blocks of 6 x 6, E and F dense.
#[derive(Debug, Clone, PartialEq)]
pub struct BorderedMatrix {
    pairs: ImagePairs,
    blocks: Vec<Matrix6<f64>>,
    /// E, with six rows for each image.
    pub border: DMatrix<f64>,
    /// F.
    pub corner: DMatrix<f64>,
}

impl BorderedMatrix {
    /// Creates a matrix of zeros.
    #[must_use]
    pub fn zeros(pairs: ImagePairs, border: usize) -> Self {
        let rows = IMAGE_UNKNOWNS * pairs.images();
        Self {
            blocks: vec![Matrix6::zeros(); pairs.blocks()],
            border: DMatrix::zeros(rows, border),
            corner: DMatrix::zeros(border, border),
            pairs,
        }
    }

    /// Sets all elements to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Matrix6::zeros());
        self.border.fill(0.0);
        self.corner.fill(0.0);
    }

    /// Pairs of images whose blocks can differ from zero.
    #[must_use]
    pub const fn pairs(&self) -> &ImagePairs {
        &self.pairs
    }

    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.border.nrows() + self.corner.nrows()
    }

    /// Adds to the block of two images, `row ≥ column`; a pair without a common point is left out.
    pub fn add_block(&mut self, row: usize, column: usize, block: &Matrix6<f64>) {
        if let Some(number) = self.pairs.block(row, column)
            && let Some(sum) = self.blocks.get_mut(number)
        {
            *sum += block;
        }
    }

    /// Adds to an element of an image's diagonal block.
    pub fn add_to_diagonal(&mut self, image: usize, element: usize, weight: f64) {
        if let Some(block) = self.blocks.get_mut(self.pairs.start(image))
            && let Some(sum) = block.get_mut((element, element))
        {
            *sum += weight;
        }
    }

    /// Blocks of a column, in the order of [`ImagePairs::column`].
    #[must_use]
    pub fn column(&self, image: usize) -> &[Matrix6<f64>] {
        let start = self.pairs.start(image);
        let end = start + self.pairs.column(image).len();
        self.blocks.get(start..end).unwrap_or(&[])
    }

    /// Diagonal, images first.
    #[must_use]
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.pairs.images())
            .flat_map(|image| {
                let block = self.column(image).first().copied().unwrap_or_default();
                let [diagonal] = block.diagonal().data.0;
                diagonal
            })
            .chain(self.corner.diagonal().iter().copied())
            .collect()
    }
}
