//! One observed distortion.

/// The distortion observed at one measured point of one exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Observation<T> {
    /// The measured point in the sensor frame, to the right, mm.
    pub x_mm: T,
    /// The measured point in the sensor frame, upwards, mm.
    pub y_mm: T,
    /// Measured - ideal, all of it, to the right, mm.
    pub dx_mm: T,
    /// Measured - ideal, all of it, upwards, mm.
    pub dy_mm: T,
    /// δ or c̄ of the exposure along the FMC axis, as the options say, mm.
    pub regressor_mm: T,
    /// Standard deviation of `dx_mm` and of `dy_mm`, mm.
    pub sigma_mm: T,
}
