//! Terrain with relief.

/// A surface of two crossed waves about a mean height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terrain {
    /// Mean height, m.
    pub height_m: f64,
    /// Greatest departure from the mean height, m.
    pub relief_m: f64,
    /// Wavelength, m.
    pub wavelength_m: f64,
}

impl Terrain {
    /// Returns the height at a position of the ground frame, m.
    #[must_use]
    pub fn height_at(&self, [x_m, y_m]: [f64; 2]) -> f64 {
        let waves = 2.0 * std::f64::consts::PI / self.wavelength_m;
        // The two waves are at right angles, not along the axes and not in step.
        let along = (waves * (0.8 * x_m + 0.6 * y_m)).sin();
        let across = (1.37 * waves * (0.8 * y_m - 0.6 * x_m) + 1.0).sin();
        self.height_m + 0.5 * self.relief_m * (along + across)
    }
}
