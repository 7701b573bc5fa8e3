//! Radiometric correction of a sub-image.

use rayon::prelude::*;

use crate::image::Plane;
use crate::number::grey;

/// Units of a DN in a file of offsets, at most; fewer where offsets are large.
pub const OFFSET_UNIT: f64 = 8.0;
/// Value of an offset of 0 DN in a file of offsets.
pub const OFFSET_ZERO: f64 = 32_768.0;
/// Units of a gain of 1 in a file of gains.
pub const GAIN_UNIT: f64 = 20_000.0;

/// Offset and gain of every pixel: corrected = (DN - offset)/gain.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    /// Columns.
    pub width: usize,
    /// Offset, DN.
    pub offset_dn: Vec<f32>,
    /// Gain, 1 for a perfect pixel on the axis.
    pub gain: Vec<f32>,
    /// Columns and rows of defective pixels, which get the mean of their neighbours.
    pub defects: Vec<[usize; 2]>,
}

impl Correction {
    /// Returns the correction from files of offsets, with the units of a DN, and gains; `None`
    /// unless all have one size.
    #[must_use]
    pub fn of_files(
        offsets: &Plane,
        offset_unit: f64,
        gains: &Plane,
        defects: Vec<[usize; 2]>,
    ) -> Option<Self> {
        let offset =
            |value: u16| crate::number::single((f64::from(value) - OFFSET_ZERO) / offset_unit);
        let alike = [offsets.width(), offsets.height()] == [gains.width(), gains.height()];
        alike.then(|| Self {
            width: offsets.width(),
            offset_dn: offsets
                .values()
                .iter()
                .map(|value| offset(*value))
                .collect(),
            gain: gains
                .values()
                .iter()
                .map(|value| crate::number::single(f64::from(*value) / GAIN_UNIT))
                .collect(),
            defects,
        })
    }

    /// Returns the units of a DN in which all offsets fit into a file: the largest power of two up
    /// to [`OFFSET_UNIT`]. Defective pixels do not count.
    #[must_use]
    pub fn offset_unit(&self) -> f64 {
        let mut largest: f64 = 0.0;
        for (index, offset) in self.offset_dn.iter().enumerate() {
            let size = f64::from(offset.abs());
            if size > largest {
                let place = [index % self.width.max(1), index / self.width.max(1)];
                if !self.defects.contains(&place) {
                    largest = size;
                }
            }
        }
        let mut unit = OFFSET_UNIT;
        while unit * largest > OFFSET_ZERO - 1.0 && unit > 1e-3 {
            unit /= 2.0;
        }
        unit
    }

    /// Returns a row of the file of offsets in units of a DN.
    #[must_use]
    pub fn offset_row(&self, row: usize, unit: f64) -> Vec<f64> {
        let values = self
            .offset_dn
            .iter()
            .skip(row * self.width)
            .take(self.width);
        let units = values.map(|value| f64::from(*value) * unit + OFFSET_ZERO);
        units.map(|units| f64::from(grey(units))).collect()
    }

    /// Returns a row of the file of gains.
    #[must_use]
    pub fn gain_row(&self, row: usize) -> Vec<f64> {
        let values = self.gain.iter().skip(row * self.width).take(self.width);
        values
            .map(|value| f64::from(grey(f64::from(*value) * GAIN_UNIT)))
            .collect()
    }

    /// Returns the corrected value of a pixel.
    #[must_use]
    pub fn value(&self, index: usize, dn: f64) -> f64 {
        match (self.offset_dn.get(index), self.gain.get(index)) {
            (Some(offset), Some(gain)) if *gain > 0.0 => {
                (dn - f64::from(*offset)) / f64::from(*gain)
            }
            _ => 0.0,
        }
    }

    /// Corrects an image in place; no value becomes 0, which means no content. Returns `false` for
    /// an image of another size, which stays as it is.
    #[must_use]
    pub fn apply(&self, image: &mut Plane) -> bool {
        if image.width() != self.width || image.values().len() != self.gain.len() {
            return false;
        }
        let values = image.values_mut().par_iter_mut().enumerate();
        values.for_each(|(index, value)| {
            *value = grey(self.value(index, f64::from(*value))).max(1);
        });
        for [col, row] in &self.defects {
            let mut neighbours = Vec::new();
            for (by_col, by_row) in [(0, 1), (2, 1), (1, 0), (1, 2)] {
                let place = [
                    (col + by_col).wrapping_sub(1),
                    (row + by_row).wrapping_sub(1),
                ];
                if !self.defects.contains(&place) {
                    neighbours.extend(image.at(place[0], place[1]).map(f64::from));
                }
            }
            let count = crate::number::real(neighbours.len());
            let mean = neighbours.iter().sum::<f64>() / count;
            if let Some(slot) = image.values_mut().get_mut(row * self.width + col)
                && mean.is_finite()
            {
                *slot = grey(mean);
            }
        }
        true
    }
}
