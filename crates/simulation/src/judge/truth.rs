//! True values of what a record states.

/// True values of one exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhysicalTruth {
    /// Principal point at the centroid of the light, sensor frame, mm.
    pub principal_point_mm: [f64; 2],
    /// Direction of the FMC axis in the sensor frame.
    pub axis: [f64; 2],
    /// Centroid of the light on the camera's clock, µs.
    pub centroid_us: f64,
    /// Centroid of the light, ns since 1970 UTC; `None` without a receiver.
    pub centroid_unix_ns: Option<i64>,
    /// V/H over the ground below at the centroid, 1/s.
    pub vh_per_s: f64,
    /// Largest motion of an image point on the detector, px.
    pub smear_px: f64,
    /// Image motion along the FMC axis at the principal point that compensation leaves, px, signed:
    /// neither attitude nor wind across the track is in it.
    pub compensation_px: f64,
}
