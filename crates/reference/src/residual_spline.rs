//! Residual grid in double precision.

use fmc_camera::geometry::grid::ResidualGrid;

/// Uniform cubic B-spline of two components, by the recursion of de Boor and Cox, which the camera
/// does not use.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualSpline {
    first_mm: [f64; 2],
    pitch_mm: f64,
    columns: usize,
    /// Coefficients of x and y, mm, node by node along x, row by row along y.
    coefficients_mm: Vec<[f64; 2]>,
}

impl ResidualSpline {
    /// Returns the spline whose first node and pitch are given, with rows of `columns` nodes.
    #[must_use]
    pub const fn new(
        first_mm: [f64; 2],
        pitch_mm: f64,
        columns: usize,
        coefficients_mm: Vec<[f64; 2]>,
    ) -> Self {
        Self {
            first_mm,
            pitch_mm,
            columns,
            coefficients_mm,
        }
    }

    /// Returns the spline of a grid, with its coefficients as they are stored.
    #[must_use]
    pub fn of(grid: &ResidualGrid<'_>) -> Self {
        let header = grid.header();
        let places = (0..header.rows).flat_map(|row| (0..header.columns).map(move |j| (j, row)));
        let scale = f64::from(header.scale_mm);
        let in_mm = |[x, y]: [i16; 2]| [f64::from(x) * scale, f64::from(y) * scale];
        let first = header.first_node;
        Self {
            first_mm: [first.x_mm, first.y_mm].map(f64::from),
            pitch_mm: f64::from(header.pitch_mm),
            columns: usize::from(header.columns),
            coefficients_mm: places
                .filter_map(|(column, row)| grid.coefficient(column, row))
                .map(in_mm)
                .collect(),
        }
    }

    /// Returns the displacement at a point of the grid's own frame, mm; zero where no node reaches.
    ///
    /// # Model
    /// ΣΣ c_ji·B((x-x_j)/p)·B((y-y_i)/p), B the cubic B-spline centred on 0.
    #[must_use]
    pub fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [first_x, first_y] = self.first_mm;
        let (first_column, of_columns) = weights((x - first_x) / self.pitch_mm);
        let (first_row, of_rows) = weights((y - first_y) / self.pitch_mm);
        let mut sum = [0.0; 2];
        let rows = self.coefficients_mm.chunks(self.columns.max(1));
        for (nodes, of_row) in rows.skip(first_row).zip(of_rows) {
            for ([cx, cy], of_column) in nodes.iter().skip(first_column).zip(of_columns) {
                let weight = of_row * of_column;
                let [sum_x, sum_y] = sum;
                sum = [sum_x + weight * cx, sum_y + weight * cy];
            }
        }
        sum
    }
}

/// Nodes along a side that reach a place, one more than the spline has.
const REACH: usize = 5;

/// Returns the first node that reaches a place, counted in nodes.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place before the first node, or a NaN, becomes 0"
)]
const fn first_node(place: f64) -> usize {
    (place - 2.0) as usize
}

/// Returns the first node that reaches a place, counted in nodes, and the weights of it and of the
/// nodes after it.
fn weights(place: f64) -> (usize, [f64; REACH]) {
    let first = first_node(place);
    let of_node = |after: usize| basis(place - count(first) - count(after));
    (first, std::array::from_fn(of_node))
}

/// Returns the cubic B-spline that is centred on 0 and has its knots at whole numbers.
fn basis(t: f64) -> f64 {
    if t.abs() < 2.0 {
        recursion(4, t + 2.0)
    } else {
        0.0
    }
}

/// Returns the B-spline of an order with the knots 0, 1, … (de Boor and Cox).
fn recursion(order: u8, t: f64) -> f64 {
    if !(0.0..f64::from(order)).contains(&t) {
        return 0.0;
    }
    if order <= 1 {
        return 1.0;
    }
    let below = f64::from(order - 1);
    (t * recursion(order - 1, t) + (below + 1.0 - t) * recursion(order - 1, t - 1.0)) / below
}

#[expect(clippy::cast_precision_loss, reason = "exact: a grid has few nodes")]
const fn count(nodes: usize) -> f64 {
    nodes as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn basis_has_the_values_of_the_cardinal_spline_and_sums_to_one() {
        for (t, value) in [
            (0.0, 4.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (0.5, 23.0 / 8.0),
            (2.0, 0.0),
        ] {
            assert!((basis(t) - value / 6.0).abs() < 1e-15, "{t}");
        }
        let sum: f64 = [-1.7, -0.7, 0.3, 1.3].into_iter().map(basis).sum();
        assert!((sum - 1.0).abs() < 1e-15);
    }

    /// Coefficients that are linear in the place reproduce the linear function.
    #[test]
    fn linear_coefficients_give_the_linear_function() {
        let nodes = (0..30_u8).map(|node| {
            let [x, y] = [node % 6, node / 6].map(|place| -4.0 + 1.5 * f64::from(place));
            [2.0 * x - y, 0.5 * y]
        });
        let spline = ResidualSpline::new([-4.0, -4.0], 1.5, 6, nodes.collect());
        let [x, y] = spline.displacement([0.37, -0.81]);
        assert!((x - (2.0 * 0.37 + 0.81)).abs() < 1e-14 && (y + 0.5 * 0.81).abs() < 1e-14);
    }
}
