//! Coordinates with which points are answered.

/// Coordinates of an answer, as `docs/formats.md` has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// Ideal points about the principal point of their frame.
    Ideal,
    /// Ideal points about the calibrated principal point.
    IdealShifted,
    /// Measured points about the calibrated principal point, with their distortion.
    MeasuredShifted,
}
