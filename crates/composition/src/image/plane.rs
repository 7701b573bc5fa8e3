//! An image in memory.

use rayon::prelude::*;

/// Grey values of 16 bits, row by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plane {
    width: usize,
    height: usize,
    values: Vec<u16>,
}

impl Plane {
    /// Returns an image of these rows; `None` unless there are width x height values, at least one.
    #[must_use]
    pub fn new(width: usize, height: usize, values: Vec<u16>) -> Option<Self> {
        let fits = width > 0 && height > 0 && width.checked_mul(height) == Some(values.len());
        fits.then_some(Self {
            width,
            height,
            values,
        })
    }

    /// Computes an image row by row, in several threads; every row is cut or filled up with 0 to
    /// the width.
    #[must_use]
    pub fn of_rows(width: usize, height: usize, row: impl Fn(usize) -> Vec<u16> + Sync) -> Self {
        let values = (0..height)
            .into_par_iter()
            .flat_map_iter(|number| {
                let mut row = row(number);
                row.resize(width, 0);
                row
            })
            .collect();
        Self {
            width,
            height,
            values,
        }
    }

    /// Columns.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Returns a row; empty beyond the image.
    #[must_use]
    pub fn row(&self, row: usize) -> &[u16] {
        let first = row.saturating_mul(self.width);
        self.values
            .get(first..first.saturating_add(self.width))
            .unwrap_or_default()
    }

    /// Returns a grey value; `None` beyond the image.
    #[must_use]
    pub fn at(&self, col: usize, row: usize) -> Option<u16> {
        self.row(row).get(col).copied()
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &[u16] {
        &self.values
    }

    /// All values, to be changed.
    pub fn values_mut(&mut self) -> &mut [u16] {
        &mut self.values
    }
}
