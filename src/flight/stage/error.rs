//! Reasons why a travel cannot be made.

use core::fmt;

use crate::geometry::range::OutOfRange;

/// The travel does not fit the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrokeTooShort {
    /// Start of the travel that is needed, mm from the calibrated position.
    pub from_mm: f32,
    /// Its end, mm.
    pub to_mm: f32,
    /// Half of the stroke, mm.
    pub half_stroke_mm: f32,
}

impl fmt::Display for StrokeTooShort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the exposure moves the principal point from {:.4} mm to {:.4} mm, the stroke allows -{:.4} mm to {:.4} mm",
            self.from_mm, self.to_mm, self.half_stroke_mm, self.half_stroke_mm
        )
    }
}

impl core::error::Error for StrokeTooShort {}

/// The reason why the stage cannot make a travel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PlanError {
    /// A quantity is outside its range.
    OutOfRange(OutOfRange),
    /// The travel leaves the stroke.
    Stroke(StrokeTooShort),
    /// The speed exceeds the stage's largest.
    Speed {
        /// Speed along the FMC axis that is asked for, mm/s.
        wanted_mm_s: f32,
        /// Largest speed of the stage, in either direction, mm/s.
        max_mm_s: f32,
    },
    /// The travel takes longer than the time available.
    Time {
        /// Time that the travel takes, s.
        needed_s: f32,
        /// Time available, s.
        available_s: f32,
    },
}

impl From<OutOfRange> for PlanError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<StrokeTooShort> for PlanError {
    fn from(error: StrokeTooShort) -> Self {
        Self::Stroke(error)
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Stroke(error) => error.fmt(f),
            Self::Speed {
                wanted_mm_s,
                max_mm_s,
            } => write!(
                f,
                "the exposure needs a speed of {wanted_mm_s} mm/s, the stage allows -{max_mm_s} mm/s to {max_mm_s} mm/s"
            ),
            Self::Time {
                needed_s,
                available_s,
            } => write!(
                f,
                "the travel takes {needed_s:.4} s, there are {available_s:.4} s"
            ),
        }
    }
}

impl core::error::Error for PlanError {}
