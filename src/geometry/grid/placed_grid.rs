//! Residual grid as it lies over the sensor during an exposure, evaluated per point.

use super::header::{GridCarrier, GridHeader};
use super::node::{NODE_BYTES, components};
use super::range::MIN_SIDE_NODES;
use super::residual_grid::ResidualGrid;
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::sensor::{FmcAxis, SensorPoint};

/// Nodes along a side that the value in a cell depends on.
const ORDER: usize = 4;

/// Number of units of a fixed weight in 1.
const ONE: f32 = 32768.0;

/// A residual grid at its place over the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedGrid<'a> {
    nodes: &'a [[u8; NODE_BYTES]],
    columns: usize,
    /// Place of a point, counted in nodes from the first cell on: `per_mm`·(x, y) + `offset`.
    per_mm: f32,
    offset: [f32; 2],
    /// Number of the last cell along x and y, the first is 0, and the place at which it ends.
    last_cell: [u32; 2],
    end: [f32; 2],
    /// Scale of the coefficients over the 6·2¹⁵ by which the weights are too large, mm.
    scale_mm: f32,
}

impl<'a> PlacedGrid<'a> {
    /// Returns the grid with the stage at the calibrated position.
    #[must_use]
    pub fn calibrated(grid: &ResidualGrid<'a>) -> Self {
        Self::new(grid, FmcAxis::PlusY, 0.0, 0.0)
    }

    /// Returns the grid of an exposure.
    ///
    /// # Model
    /// A grid of the lens is evaluated at ((x, y) - c̄·e)/(1+κ), one of the sensor at (x, y).
    ///
    /// # Units and frames
    /// `centroid_mm` is c̄, the principal point's offset along `axis`; `enlargement` is κ of the
    /// focus shift.
    #[must_use]
    pub fn new(grid: &ResidualGrid<'a>, axis: FmcAxis, centroid_mm: f32, enlargement: f32) -> Self {
        let GridHeader {
            carrier,
            columns,
            rows,
            first_node,
            pitch_mm,
            scale_mm,
        } = *grid.header();
        let (shift, scale) = match carrier {
            GridCarrier::Lens => (
                axis.sensor_from_offset(SensorPoint::default(), centroid_mm),
                1.0 + enlargement,
            ),
            GridCarrier::Sensor => (SensorPoint::default(), 1.0),
        };
        let per_mm = 1.0 / (scale * pitch_mm);
        let offset =
            |shift_mm: f32, first_mm: f32| -(shift_mm * per_mm + first_mm / pitch_mm + 1.0);
        let sides = [columns, rows];
        Self {
            nodes: grid.nodes(),
            columns: usize::from(columns),
            per_mm,
            offset: [
                offset(shift.x_mm, first_node.x_mm),
                offset(shift.y_mm, first_node.y_mm),
            ],
            last_cell: sides.map(|nodes| u32::from(nodes.saturating_sub(MIN_SIDE_NODES))),
            end: sides.map(|nodes| f32::from(nodes.saturating_sub(MIN_SIDE_NODES - 1))),
            scale_mm: scale_mm / (6.0 * ONE),
        }
    }

    /// Nodes per mm of the sensor.
    #[must_use]
    pub const fn per_mm(&self) -> f32 {
        self.per_mm
    }

    /// Place of the sensor's origin, counted in nodes from the second node of the grid on.
    #[must_use]
    pub const fn origin(&self) -> [f32; 2] {
        self.offset
    }

    /// Nodes of a row.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Coefficients of x and y in units of [`Self::unit_mm`], row by row along y.
    pub fn coefficients(&self) -> impl Iterator<Item = [i16; 2]> + '_ {
        self.nodes.iter().map(|node| components(*node))
    }

    /// Unit of the coefficients, mm.
    #[must_use]
    pub const fn unit_mm(&self) -> f32 {
        self.scale_mm * (6.0 * ONE)
    }

    /// Returns the displacement at a point, measured - ideal.
    ///
    /// # Model
    /// Uniform cubic B-spline: in cell j = ⌊s⌋, u = s - j, the nodes j-1 to j+2 have the weights
    /// (1-u)³, 3u³-6u²+4, -3u³+3u²+3u+1 and u³, each over 6, along either axis (CALIBRATIONS
    /// section 9). Beyond the cells it is the value at their nearest border.
    ///
    /// # Units and frames
    /// Sensor frame, mm. A point that is not a number has a displacement that is not one.
    ///
    /// # Accuracy
    /// Of the same spline in double precision: 2⁻¹³ of the largest difference of neighbouring
    /// nodes, since the weights along x have 15 bits; 0.07 nm for 3 µm of structure in waves of ten
    /// nodes, 0.5 nm in waves of two and a half. The bits are the same on PC and target.
    #[inline]
    #[must_use]
    pub fn displacement(&self, point: SensorPoint) -> Displacement {
        let [offset_x, offset_y] = self.offset;
        let [last_x, last_y] = self.last_cell;
        let [end_x, end_y] = self.end;
        let (column, across) = cell(point.x_mm * self.per_mm + offset_x, last_x, end_x);
        let (row, along) = cell(point.y_mm * self.per_mm + offset_y, last_y, end_y);
        // A cell has all of its nodes: the numbers of nodes have been checked.
        let Some(rows) = self.rows(row * self.columns + column) else {
            return Displacement {
                dx_mm: f32::NAN,
                dy_mm: f32::NAN,
            };
        };
        let across_weights = fixed_weights(across);
        let mut sum = [0.0; 2];
        for (nodes, weight) in rows.into_iter().zip(weights(along)) {
            let [x, y] = row_sum(nodes, across_weights);
            let [sum_x, sum_y] = sum;
            sum = [sum_x + weight * x, sum_y + weight * y];
        }
        let [x, y] = sum;
        // A NaN among the places has left the fixed weights; it returns here.
        let scale_mm = self.scale_mm + 0.0 * across;
        Displacement {
            dx_mm: x * scale_mm,
            dy_mm: y * scale_mm,
        }
    }

    /// Returns the nodes of the cell with the given first node, row by row.
    #[inline]
    fn rows(&self, first: usize) -> Option<[&'a [[u8; NODE_BYTES]; ORDER]; ORDER]> {
        let row = |first: usize| self.nodes.get(first..)?.first_chunk();
        let columns = self.columns;
        Some([
            row(first)?,
            row(first + columns)?,
            row(first + 2 * columns)?,
            row(first + 3 * columns)?,
        ])
    }
}

/// Returns the first node of a cell along an axis and the place in the cell, 0 to 1, of a place
/// counted in nodes from the first cell on.
#[inline]
fn cell(place: f32, last_cell: u32, end: f32) -> (usize, f32) {
    // A NaN passes; `clamp` would check its arguments for every point.
    let place = if place < 0.0 {
        0.0
    } else if place > end {
        end
    } else {
        place
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the whole part of a number between 0 and 4096; a NaN becomes 0"
    )]
    let cell = (place as u32).min(last_cell);
    #[expect(clippy::cast_precision_loss, reason = "exact: at most 4096")]
    let within = place - cell as f32;
    (cell as usize, within)
}

/// Returns the weights of the four nodes, six times as large as those of the mean.
#[inline]
fn weights(u: f32) -> [f32; ORDER] {
    let rest = 1.0 - u;
    let (u2, rest2) = (u * u, rest * rest);
    // 3u³-6u²+4 and, by symmetry, the same of 1-u.
    [
        rest2 * rest,
        (3.0 * u - 6.0) * u2 + 4.0,
        (3.0 * rest - 6.0) * rest2 + 4.0,
        u2 * u,
    ]
}

/// Returns the weights of the four nodes in units of 2⁻¹⁵; their sum is exactly 1, so that their
/// rounding meets the differences of coefficients alone.
#[inline]
fn fixed_weights(u: f32) -> [i16; ORDER] {
    let [w0, w1, w2, _] = weights(u);
    // By way of 32 bits, to which the processor converts.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounds a number between 0 and 2/3 of 2^15; a NaN becomes 0"
    )]
    let fixed = |weight: f32| (weight * (ONE / 6.0) + 0.5) as i32 as i16;
    let [w0, w1, w2] = [w0, w1, w2].map(fixed);
    // 2¹⁵ is -2¹⁵ here; what is left of it, at most a sixth, is right.
    let rest = i16::MIN.wrapping_sub(w0).wrapping_sub(w1).wrapping_sub(w2);
    [w0, w1, w2, rest]
}

/// Returns the sums of a row of nodes by their weights, in units of 2⁻¹⁵.
#[inline]
fn row_sum(nodes: &[[u8; NODE_BYTES]; ORDER], weights: [i16; ORDER]) -> [f32; 2] {
    let mut sum = [0_i32; 2];
    // Less than 2¹⁵ by 2¹⁵ and a rounding in all.
    for (node, weight) in nodes.iter().zip(weights) {
        let [x, y] = components(*node).map(|component| i32::from(component) * i32::from(weight));
        let [sum_x, sum_y] = sum;
        sum = [sum_x.wrapping_add(x), sum_y.wrapping_add(y)];
    }
    #[expect(
        clippy::cast_precision_loss,
        reason = "rounded to 2^-24 of the largest coefficient"
    )]
    sum.map(|sum| sum as f32)
}
