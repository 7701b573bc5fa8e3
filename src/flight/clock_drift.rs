//! Drift of a board's clock against the time pulses.

/// Error of the rate of a board's clock by the receiver's time pulses, and the part of it by which
/// camera time is corrected. What is left is in the conversion to UTC.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClockDrift {
    /// Error of the rate, ppm; positive if the clock runs fast.
    pub drift_ppm: f32,
    /// Error of the rate that is corrected, ppm.
    pub corrected_ppm: f32,
}

impl ClockDrift {
    /// Returns the drift of a clock of which so much is corrected, while camera time is off by
    /// another rate, ppm.
    ///
    /// # Model
    /// Camera time goes on by `1 + u` while true time goes on by 1, and the clock by `1 + c` while
    /// camera time goes on by 1: `d = (1 + c)(1 + u) - 1`.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::flight::clock_drift::ClockDrift;
    ///
    /// let drift = ClockDrift::after_correction(4000.0, 10.0);
    /// assert!((drift.drift_ppm - 4010.04).abs() < 1e-3);
    /// ```
    #[must_use]
    pub const fn after_correction(corrected_ppm: f32, left_ppm: f32) -> Self {
        Self {
            drift_ppm: corrected_ppm + left_ppm + 1e-6 * corrected_ppm * left_ppm,
            corrected_ppm,
        }
    }
}
