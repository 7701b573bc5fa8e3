//! Residual grid as it lies over the sensor during an exposure, evaluated per point.

use super::header::{GridCarrier, GridHeader};
use super::node::{NODE_BYTES, components};
use super::range::MIN_SIDE_NODES;
use super::residual_grid::ResidualGrid;
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::sensor::{FmcAxis, SensorPoint};

/// Nodes along a side that the value in a cell depends on.
const ORDER: usize = 4;

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
    /// Scale of the coefficients over the 36 by which the weights are too large, mm.
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
            scale_mm: scale_mm / 36.0,
        }
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
    /// 0.1 nm of the same spline in double precision, for 3 µm of structure over 54 mm; the bits
    /// are the same on PC and target.
    #[inline]
    #[must_use]
    pub fn displacement(&self, point: SensorPoint) -> Displacement {
        let [offset_x, offset_y] = self.offset;
        let [last_x, last_y] = self.last_cell;
        let [end_x, end_y] = self.end;
        let (column, across) = cell(point.x_mm * self.per_mm + offset_x, last_x, end_x);
        let (row, along) = cell(point.y_mm * self.per_mm + offset_y, last_y, end_y);
        let mut sum = [0.0; 2];
        let mut first = row * self.columns + column;
        for weight in weights(along) {
            let nodes = self.nodes.get(first..).and_then(<[_]>::first_chunk);
            // A cell has all of its nodes: the numbers of nodes have been checked.
            let Some(nodes) = nodes else {
                return Displacement {
                    dx_mm: f32::NAN,
                    dy_mm: f32::NAN,
                };
            };
            let [x, y] = row_sum(nodes, weights(across));
            let [sum_x, sum_y] = sum;
            sum = [sum_x + weight * x, sum_y + weight * y];
            first += self.columns;
        }
        let [x, y] = sum;
        Displacement {
            dx_mm: x * self.scale_mm,
            dy_mm: y * self.scale_mm,
        }
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

/// Returns the sums of a row of nodes by their weights.
#[inline]
fn row_sum(nodes: &[[u8; NODE_BYTES]; ORDER], [w0, w1, w2, w3]: [f32; ORDER]) -> [f32; 2] {
    let [n0, n1, n2, n3] = nodes.map(|node| components(node).map(f32::from));
    let sum = |c0: f32, c1: f32, c2: f32, c3: f32| w0 * c0 + w1 * c1 + w2 * c2 + w3 * c3;
    let ([x0, y0], [x1, y1], [x2, y2], [x3, y3]) = (n0, n1, n2, n3);
    [sum(x0, x1, x2, x3), sum(y0, y1, y2, y3)]
}
