//! Planimetric error on the ground.

use fmc_adjustment::collinearity::ground_at_height;
use fmc_adjustment::exterior_orientation::ExteriorOrientation;

/// Root mean square of planimetric errors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GroundError {
    squares_m2: f64,
    points: u32,
}

impl GroundError {
    /// Adds a point: intersects its ideal image (from the principal point, mm) with its surveyed
    /// height and compares the result with its surveyed position.
    pub fn add(
        &mut self,
        orientation: &ExteriorOrientation,
        principal_distance_mm: f64,
        ideal_mm: [f64; 2],
        [x_m, y_m, z_m]: [f64; 3],
    ) {
        self.points += 1;
        self.squares_m2 += match ground_at_height(orientation, principal_distance_mm, ideal_mm, z_m)
        {
            Some([x, y]) => (x - x_m).powi(2) + (y - y_m).powi(2),
            // A ray that does not come down counts as an infinite error.
            None => f64::INFINITY,
        };
    }

    /// √(mean of ΔX² + ΔY²), m: the error of a position, not of a coordinate.
    #[must_use]
    pub fn rms_m(&self) -> f64 {
        (self.squares_m2 / f64::from(self.points)).sqrt()
    }

    /// Number of points added.
    #[must_use]
    pub const fn points(&self) -> u32 {
        self.points
    }
}
