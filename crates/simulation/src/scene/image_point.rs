//! Image of a ground point.

/// Recorded image of a ground point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePoint {
    /// Centroid over the light, which is what is measured in the image, mm of the sensor frame.
    pub point_mm: [f64; 2],
    /// Motion on the detector from first light to last, mm: the residual smear.
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
