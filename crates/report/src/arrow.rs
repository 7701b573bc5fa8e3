//! A displacement at a point of the sensor.

/// A displacement at a point.
#[derive(Debug, Clone, Copy)]
pub struct Arrow {
    /// Point of the sensor frame, mm.
    pub from_mm: [f64; 2],
    /// Displacement, mm; measured - ideal.
    pub displacement_mm: [f64; 2],
}

impl Arrow {
    /// Point at which the arrow begins, mm.
    #[must_use]
    pub fn from(&self) -> (f64, f64) {
        self.from_mm.into()
    }
}

/// Returns the length of a displacement, in its unit.
#[must_use]
pub fn length_of([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
