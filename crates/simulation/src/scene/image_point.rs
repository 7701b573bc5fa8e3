//! The image of a ground point.

/// Where a ground point is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePoint {
    /// Centroid over the light: what is measured in the image, mm of the sensor frame.
    pub point_mm: [f64; 2],
    /// From first light to last on the detector, mm: the residual smear.
    pub smear_mm: [f64; 2],
}

impl ImagePoint {
    /// Length of the smear, mm.
    #[must_use]
    pub fn smear_length_mm(&self) -> f64 {
        let [x, y] = self.smear_mm;
        x.hypot(y)
    }
}
