//! A residual grid at its place over the sensor, in double precision, continued beyond its cells.

use fmc_camera::geometry::grid::PlacedGrid;

use crate::matrix::Matrix;

/// Nodes along a side that the value in a cell depends on.
const ORDER: usize = 4;

/// Uniform cubic B-spline of both components of the displacement.
///
/// # Model
/// Beyond the lattice the coefficients of its rim are repeated, so that the spline stays as smooth
/// as within: twice differentiable, with the bounds of [`Self::slope`] and [`Self::curvature`]
/// everywhere. On the sensor, which the cells cover, it is the camera's own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlacedSpline {
    per_mm: f64,
    /// Place of the sensor's origin, in nodes from the second one on.
    origin: [f64; 2],
    columns: usize,
    rows: usize,
    /// Coefficients, mm, row by row.
    nodes: Vec<[f64; 2]>,
}

/// Weights of the nodes of a row.
type Weights = [f64; ORDER];

impl PlacedSpline {
    pub(crate) fn of(grid: &PlacedGrid<'_>) -> Self {
        let unit_mm = f64::from(grid.unit_mm());
        let nodes: Vec<[f64; 2]> = grid
            .coefficients()
            .map(|node| node.map(|number| f64::from(number) * unit_mm))
            .collect();
        let columns = grid.columns().max(1);
        Self {
            per_mm: f64::from(grid.per_mm()),
            origin: grid.origin().map(f64::from),
            columns,
            rows: nodes.len() / columns,
            nodes,
        }
    }

    /// Returns the displacement at a point of the sensor frame, mm, and its derivatives.
    pub(crate) fn at(&self, point_mm: [f64; 2]) -> ([f64; 2], Matrix) {
        let ([column, row], [u, v]) = self.cell(point_mm);
        let (across, across_slopes) = (values(u), slopes(u));
        let [mut value, mut by_x, mut by_y] = [[0.0; 2]; 3];
        let rows = (row..).zip(values(v).into_iter().zip(slopes(v)));
        for (row, (along, along_slope)) in rows.take(ORDER) {
            let nodes = self.nodes_of(column, row);
            let [mut sum, mut sum_of_slopes] = [[0.0; 2]; 2];
            for ((node, weight), slope) in nodes.into_iter().zip(across).zip(across_slopes) {
                add(&mut sum, weight, node);
                add(&mut sum_of_slopes, slope, node);
            }
            add(&mut value, along, sum);
            add(&mut by_x, along, sum_of_slopes);
            add(&mut by_y, along_slope, sum);
        }
        let [by_x, by_y] = [by_x, by_y].map(|by| by.map(|component| component * self.per_mm));
        (value, [[by_x[0], by_y[0]], [by_x[1], by_y[1]]])
    }

    /// Returns the four nodes of a row of a cell.
    fn nodes_of(&self, column: isize, row: isize) -> [[f64; 2]; ORDER] {
        if let (Ok(first), Ok(row)) = (usize::try_from(column), usize::try_from(row))
            && first + ORDER <= self.columns
            && row < self.rows
        {
            let place = row * self.columns + first;
            let nodes = self.nodes.get(place..).and_then(<[_]>::first_chunk);
            return nodes.copied().unwrap_or_default();
        }
        [0, 1, 2, 3].map(|next| self.node(column + next, row))
    }

    /// Returns a bound of the norm of the derivatives, anywhere.
    ///
    /// # Model
    /// They are convex combinations of differences of neighbouring coefficients, over the pitch
    /// (CALIBRATIONS section 9).
    pub(crate) fn slope(&self) -> f64 {
        let of = |axis| self.largest(|place| self.difference(place, axis)) * self.per_mm;
        of([1, 0]).hypot(of([0, 1]))
    }

    /// Returns a bound of the second derivative along any direction, anywhere, mm⁻¹.
    ///
    /// # Model
    /// As [`Self::slope`], with second differences: for u of length 1, |G''(u, u)|² is at most the
    /// sum of the squares of all four second derivatives.
    pub(crate) fn curvature(&self) -> f64 {
        let second = |one: [isize; 2], other: [isize; 2]| {
            let largest = self.largest(|[column, row]| {
                let [ax, ay] = self.difference([column, row], one);
                let beside = [column + other[0], row + other[1]];
                let [bx, by] = self.difference(beside, one);
                [bx - ax, by - ay]
            });
            largest * self.per_mm * self.per_mm
        };
        let (x, y) = ([1, 0], [0, 1]);
        let [xx, xy, yy] = [second(x, x), second(x, y), second(y, y)];
        (xx * xx + 2.0 * xy * xy + yy * yy).sqrt()
    }

    /// Returns the largest length of a vector over the nodes and two more around them.
    fn largest(&self, of: impl Fn([isize; 2]) -> [f64; 2]) -> f64 {
        let places = |count: usize| -2..signed(count) + 2;
        let mut largest = 0.0_f64;
        for row in places(self.rows) {
            for column in places(self.columns) {
                let [x, y] = of([column, row]);
                largest = largest.max(x.hypot(y));
            }
        }
        largest
    }

    /// Returns the difference of a node and the next one along an axis.
    fn difference(&self, [column, row]: [isize; 2], [right, up]: [isize; 2]) -> [f64; 2] {
        let [ax, ay] = self.node(column, row);
        let [bx, by] = self.node(column + right, row + up);
        [bx - ax, by - ay]
    }

    /// Returns a node; beyond the lattice the nearest one.
    fn node(&self, column: isize, row: isize) -> [f64; 2] {
        let within = |number: isize, count: usize| {
            usize::try_from(number.max(0)).map_or(0, |number| number.min(count.saturating_sub(1)))
        };
        let place = within(row, self.rows) * self.columns + within(column, self.columns);
        self.nodes.get(place).copied().unwrap_or_default()
    }

    /// Returns the first node of the cell of a point, and the place in the cell.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a whole number within a few lattices of the sensor"
    )]
    fn cell(&self, [x, y]: [f64; 2]) -> ([isize; 2], [f64; 2]) {
        // Farther out the spline is constant.
        let most = [self.columns, self.rows].map(|count| f64::from(low(count)) + 4.0);
        let place = |along: f64, origin: f64, most: f64| {
            (along * self.per_mm + origin).clamp(-4.0 - most, most)
        };
        let places = [
            place(x, self.origin[0], most[0]),
            place(y, self.origin[1], most[1]),
        ];
        let whole = places.map(f64::floor);
        let within = [places[0] - whole[0], places[1] - whole[1]];
        (whole.map(|whole| whole as isize), within)
    }
}

/// Adds a vector times a weight.
fn add(sum: &mut [f64; 2], weight: f64, [x, y]: [f64; 2]) {
    *sum = [sum[0] + weight * x, sum[1] + weight * y];
}

/// Returns the weights of the four nodes of a cell.
fn values(u: f64) -> Weights {
    let rest = 1.0 - u;
    let (u2, rest2) = (u * u, rest * rest);
    [
        rest2 * rest,
        (3.0 * u - 6.0) * u2 + 4.0,
        (3.0 * rest - 6.0) * rest2 + 4.0,
        u2 * u,
    ]
    .map(|weight| weight / 6.0)
}

/// Returns the derivatives of the weights.
fn slopes(u: f64) -> Weights {
    let rest = 1.0 - u;
    [
        -0.5 * rest * rest,
        (1.5 * u - 2.0) * u,
        (2.0 - 1.5 * rest) * rest,
        0.5 * u * u,
    ]
}

/// Returns a number of nodes, at most 4096.
fn low(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

fn signed(count: usize) -> isize {
    isize::try_from(count).unwrap_or(isize::MAX - 2)
}

#[cfg(test)]
mod tests {
    use fmc_camera::geometry::camera_grids::CameraGrids;
    use fmc_camera::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};
    use fmc_camera::geometry::gridded_correction::GriddedCorrection;
    use fmc_camera::{Calibration, CalibrationParameters, FrameCorrection, SensorPoint};

    use super::*;

    /// Calls `check` with the spline of a grid of 3 µm, and with the camera's own.
    fn with_grid(check: impl Fn(&PlacedSpline, &GriddedCorrection<'_>)) {
        let header = GridHeader {
            carrier: GridCarrier::Lens,
            columns: 14,
            rows: 10,
            first_node: SensorPoint::new(-13.0, -9.0),
            pitch_mm: 2.0,
            scale_mm: 1e-7,
        };
        let mut random = fastrand::Rng::with_seed(21);
        let mut file = header.to_bytes().to_vec();
        for _ in 0..2 * 14 * 10 {
            file.extend(random.i16(-30_000..30_000).to_le_bytes());
        }
        file.extend(GridHeader::checksum(&file).to_le_bytes());
        let parameters = CalibrationParameters::new(100.0, [2000, 1000], 10.0);
        let calibration = Calibration::new(parameters).unwrap();
        let grid = ResidualGrid::parse(&file).unwrap();
        let grids = CameraGrids::new(&calibration, Some(grid), None).unwrap();
        let still = FrameCorrection::without_motion(&calibration);
        let correction = GriddedCorrection::calibrated(still, &grids);
        check(&PlacedSpline::of(correction.lens().unwrap()), &correction);
    }

    /// 2⁻¹³ of the largest difference of neighbouring nodes is 0.7 nm here.
    #[test]
    fn on_the_sensor_it_is_the_grid_of_the_camera_within_a_nanometre() {
        with_grid(|spline, camera| {
            let mut random = fastrand::Rng::with_seed(1);
            let mut largest = 0.0_f64;
            for _ in 0..2000 {
                let [x, y] = [10.0, 5.0].map(|half| half * (2.0 * random.f32() - 1.0));
                let camera = camera.residual(SensorPoint::new(x, y));
                let ([dx, dy], _) = spline.at([x, y].map(f64::from));
                let error = [f64::from(camera.dx_mm) - dx, f64::from(camera.dy_mm) - dy];
                largest = largest.max(error[0].abs()).max(error[1].abs());
            }
            assert!(largest > 0.0 && largest < 1e-6, "{largest} mm");
        });
    }

    #[test]
    fn derivatives_are_those_of_differences_and_stay_within_their_bounds_beyond_the_cells_too() {
        with_grid(|spline, _| {
            const STEP_MM: f64 = 1e-4;
            let mut random = fastrand::Rng::with_seed(2);
            let [slope, curvature] = [spline.slope(), spline.curvature()];
            let [mut steepest, mut bent] = [0.0_f64; 2];
            for _ in 0..5000 {
                let [x, y] = [24.0, 18.0].map(|half| half * (2.0 * random.f64() - 1.0));
                let (_, jacobian) = spline.at([x, y]);
                let at = |step: [f64; 2]| spline.at([x + step[0], y + step[1]]).0;
                for (axis, step) in [[STEP_MM, 0.0], [0.0, STEP_MM]].into_iter().enumerate() {
                    let ([ax, ay], [bx, by]) = (at(step.map(|step| -step)), at(step));
                    let [dx, dy] = [bx - ax, by - ay].map(|change| change / (2.0 * STEP_MM));
                    let error = (dx - jacobian[0][axis]).hypot(dy - jacobian[1][axis]);
                    assert!(error < 1e-7, "{x}, {y}: {error}");
                    steepest = steepest.max(dx.hypot(dy));
                    let [mx, my] = at([0.0; 2]);
                    let second = [ax - 2.0 * mx + bx, ay - 2.0 * my + by]
                        .map(|change| change / (STEP_MM * STEP_MM));
                    bent = bent.max(second[0].hypot(second[1]));
                }
            }
            // A bound that is far above every value would say nothing.
            assert!(
                (0.2 * slope..slope).contains(&steepest),
                "{steepest} of {slope}"
            );
            assert!(
                (0.2 * curvature..curvature).contains(&bent),
                "{bent} of {curvature}"
            );
        });
    }
}
