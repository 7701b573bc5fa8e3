//! A displacement at a point of the sensor.

/// A displacement at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrow {
    pub(crate) from_mm: [f64; 2],
    pub(crate) displacement_mm: [f64; 2],
}

impl Arrow {
    /// Point at which the arrow begins, mm.
    pub(crate) fn from(&self) -> (f64, f64) {
        self.from_mm.into()
    }
}

/// Returns the length of a displacement, in its unit.
pub(crate) fn length_of([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
