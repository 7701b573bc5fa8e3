//! Bound of the error of a mesh that is interpolated linearly.

use crate::form::Form;
use crate::matrix::{Matrix, inverse, length, times};

/// Cells of the sensor, along each axis, over each of which the derivatives are bounded: the fewest
/// and the most.
const CELLS: [u32; 2] = [128, 2048];

/// Bounds of the map from ideal to measured points over a rectangle of the sensor frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SourceBounds {
    /// Largest length of the second derivatives by x and by y, mm⁻¹.
    pub(crate) second_per_mm: [f64; 2],
    /// Largest stretch: way of the measured point by way of the ideal one.
    pub(crate) stretch: f64,
}

impl SourceBounds {
    /// Returns the bounds over the measured points within `half_mm` of the sensor's centre; `None`
    /// if the map might fold there.
    ///
    /// # Model
    /// With A = (1 - D')⁻¹ at the measured point the map has the derivatives A·u and
    /// `A·D''(A·u, A·u)` along u. Both are evaluated in the middle of cells. To a cell's corner, h
    /// away, A changes at most to `|A|/(1 - h|A||D''|)`, and the second derivative by
    /// `h(|A|³|D'''| + 3|A|⁴|D''|²)`, with |D''| and |D'''| at their largest within the cell's
    /// largest radius. Residual grids G are taken by their bounds: A is at most
    /// `|A|/(1 - |A|(h|D''| + |G'|))`, and the second derivative changes by `|A|³|G''| +
    /// 3|A|⁴|D''||G'|` more.
    pub(crate) fn over(form: &Form, half_mm: [f64; 2]) -> Option<Self> {
        let mut cells = CELLS[0];
        while cells <= CELLS[1] {
            if let Some(found) = Self::by_cells(form, half_mm, cells) {
                return Some(found);
            }
            cells *= 4;
        }
        None
    }

    fn by_cells(form: &Form, half_mm: [f64; 2], cells: u32) -> Option<Self> {
        let mut found = Self {
            second_per_mm: [0.0; 2],
            stretch: 0.0,
        };
        let side = half_mm.map(|half| 2.0 * half / f64::from(cells));
        let reach = 0.5 * length(side);
        let residual = form.residual_bounds();
        for row in 0..cells {
            for col in 0..cells {
                let middle = [
                    (f64::from(col) + 0.5) * side[0] - half_mm[0],
                    (f64::from(row) + 0.5) * side[1] - half_mm[1],
                ];
                let inverse = inverse(form.polynomial_jacobian(middle))?;
                let (_, r2) = form.centred(middle);
                let [second, third] = form.largest_derivatives(r2.sqrt() + reach);
                let turned = reach * second + residual.slope;
                let left = 1.0 - norm(inverse) * turned;
                // Otherwise the cells are too large, or the map folds.
                (left >= 0.5).then_some(())?;
                let stretch = norm(inverse) / left;
                found.stretch = found.stretch.max(stretch);
                let cube = stretch * stretch * stretch;
                let change =
                    cube * (reach * third + residual.curvature + 3.0 * stretch * second * turned);
                for (largest, axis) in found.second_per_mm.iter_mut().zip([[1.0, 0.0], [0.0, 1.0]])
                {
                    let along = times(inverse, axis);
                    let second = times(inverse, form.second_derivative(middle, along));
                    *largest = largest.max(length(second) + change);
                }
            }
        }
        Some(found)
    }
}

/// Returns the largest length of a matrix times a vector of length one.
fn norm([[a, b], [c, d]]: Matrix) -> f64 {
    let sum = a * a + b * b + c * c + d * d;
    let determinant = a * d - b * c;
    let root = (sum * sum - 4.0 * determinant * determinant)
        .max(0.0)
        .sqrt();
    (0.5 * (sum + root)).sqrt()
}
