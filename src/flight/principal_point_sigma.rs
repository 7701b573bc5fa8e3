//! Standard deviation of a principal point, in two parts.

/// Standard deviation of the centroid principal point along the FMC axis.
///
/// A block adjustment takes [`Self::frame_mm`] as independent from frame to frame and
/// [`Self::common_mm`] as one unknown of the flight: the mean of n frames has the variance
/// `frame²/n + common²`, never `(frame² + common²)/n`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PrincipalPointSigma {
    /// Of this frame alone, mm: steps of the encoder, time stamps, the path between two readings,
    /// how far the reading went while the stage stood, or half of the stroke where readings are
    /// missing.
    pub frame_mm: f32,
    /// Common to the frames of a flight, mm: phase, zero and scale of the encoder, age of its
    /// readings, play, or half of the stroke where the place is lost.
    pub common_mm: f32,
}

impl PrincipalPointSigma {
    /// Both together, mm: the standard deviation of one principal point.
    #[must_use]
    pub fn total_mm(&self) -> f32 {
        libm::hypotf(self.frame_mm, self.common_mm)
    }

    /// Returns the standard deviation where an error of the flight of this size, mm, has been found
    /// afterwards.
    #[must_use]
    pub fn in_doubt_by(self, off_mm: f32) -> Self {
        Self {
            common_mm: libm::hypotf(self.common_mm, off_mm),
            ..self
        }
    }
}
