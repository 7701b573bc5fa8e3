//! Bounds of the residual grid of a lens, by which a frame states what it leaves out.

use super::grid::ResidualGrid;
use super::hypotenuse::hypotenuse;
use super::principal_point::PrincipalPointMotion;
use super::sensor::{FmcAxis, Sensor};

/// Bounds of the residual grid of a lens whose principal point moves.
///
/// They borrow no coefficients, so that the camera in flight keeps them for its records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensGridBounds {
    slope: f32,
    /// Largest curvature along the axis, mm⁻¹.
    curvature: f32,
    /// Farthest |x| and |y| up to which there are cells on both sides, mm.
    covered_mm: [f32; 2],
    axis: FmcAxis,
}

impl LensGridBounds {
    /// Returns the bounds of a grid that moves along an axis.
    pub(super) fn new(grid: &ResidualGrid<'_>, axis: FmcAxis) -> Self {
        let bounds = grid.bounds();
        let [from, to] = grid.cells();
        Self {
            slope: bounds.slope(),
            curvature: bounds.curvature(axis.is_x()),
            covered_mm: [to.x_mm.min(-from.x_mm), to.y_mm.min(-from.y_mm)],
            axis,
        }
    }

    /// Returns an upper bound of what the grid at the centroid leaves out of its exposure mean, per
    /// axis, mm.
    ///
    /// # Model
    /// `½·μ₂·max|second difference|/pitch²`, and the slope times the way by which the image reaches
    /// beyond the cells (a focus shift that shrinks it by 10⁻⁴ reaches 3 µm beyond).
    #[must_use]
    pub(crate) fn left_out_mm(
        &self,
        sensor: &Sensor,
        motion: &PrincipalPointMotion,
        enlargement: f32,
    ) -> f32 {
        let along_x = self.axis.is_x();
        let moved_mm = motion.centroid_mm.abs();
        let (half_width, half_height) = (sensor.half_width_mm(), sensor.half_height_mm());
        // The farthest |x| and |y| at which the grid is evaluated, in its own frame.
        let reach = if along_x {
            [half_width + moved_mm, half_height]
        } else {
            [half_width, half_height + moved_mm]
        }
        .map(|reach| reach / (1.0 + enlargement));
        let second = 0.5 * motion.moments.second * self.curvature;
        second + self.slope * self.beyond_cells_mm(reach)
    }

    /// Returns the way by which a rectangle about the centre reaches beyond the cells, mm.
    fn beyond_cells_mm(&self, [reach_x, reach_y]: [f32; 2]) -> f32 {
        let [x, y] = self.covered_mm;
        let beyond = |reach: f32, covered: f32| {
            if reach > covered {
                reach - covered
            } else {
                0.0
            }
        };
        hypotenuse(beyond(reach_x, x), beyond(reach_y, y))
    }
}
