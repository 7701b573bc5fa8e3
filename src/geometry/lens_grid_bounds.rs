//! Bounds of the residual grid of a lens, by which a frame states what it leaves out.

use super::grid::{GridBounds, ResidualGrid};
use super::hypotenuse::hypotenuse;
use super::principal_point::PrincipalPointMotion;
use super::sensor::{FmcAxis, Sensor, SensorPoint};

/// Bounds of the residual grid of a lens whose principal point moves.
///
/// They borrow no coefficients, so that the camera in flight keeps them for its records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LensGridBounds {
    bounds: GridBounds,
    cells: [SensorPoint; 2],
    axis: FmcAxis,
}

impl LensGridBounds {
    /// Returns the bounds of a grid that moves along an axis.
    pub(super) fn new(grid: &ResidualGrid<'_>, axis: FmcAxis) -> Self {
        Self {
            bounds: *grid.bounds(),
            cells: grid.cells(),
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
        let second = motion.moments.second;
        self.bounds.second_moment_mm(second, along_x)
            + self.bounds.slope() * self.beyond_cells_mm(reach)
    }

    /// Returns the way by which a rectangle about the centre reaches beyond the cells, mm.
    fn beyond_cells_mm(&self, [reach_x, reach_y]: [f32; 2]) -> f32 {
        let [from, to] = self.cells;
        let beyond = |reach: f32, from: f32, to: f32| (reach - to).max(reach + from).max(0.0);
        hypotenuse(
            beyond(reach_x, from.x_mm, to.x_mm),
            beyond(reach_y, from.y_mm, to.y_mm),
        )
    }
}
