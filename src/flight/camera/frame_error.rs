//! Reasons for which a frame cannot be predicted.

use core::fmt;

use crate::flight::stage::{PlanError, StrokeTooShort};
use crate::geometry::range::OutOfRange;

/// The reason why a frame cannot be taken as asked.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FrameError {
    /// A quantity of the exposure is outside its limits.
    OutOfRange(OutOfRange),
    /// The stage cannot make the travel.
    Stroke(StrokeTooShort),
    /// The camera has no five-coefficient model.
    NotFitted,
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

impl From<OutOfRange> for FrameError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl From<StrokeTooShort> for FrameError {
    fn from(error: StrokeTooShort) -> Self {
        Self::Stroke(error)
    }
}

impl From<PlanError> for FrameError {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::OutOfRange(error) => Self::OutOfRange(error),
            PlanError::Stroke(error) => Self::Stroke(error),
            PlanError::Speed {
                wanted_mm_s,
                max_mm_s,
            } => Self::Speed {
                wanted_mm_s,
                max_mm_s,
            },
            PlanError::Time {
                needed_s,
                available_s,
            } => Self::Time {
                needed_s,
                available_s,
            },
        }
    }
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Stroke(error) => error.fmt(f),
            Self::NotFitted => f.write_str("the camera has no fitted five-coefficient model"),
            Self::Speed {
                wanted_mm_s,
                max_mm_s,
            } => PlanError::Speed {
                wanted_mm_s: *wanted_mm_s,
                max_mm_s: *max_mm_s,
            }
            .fmt(f),
            Self::Time {
                needed_s,
                available_s,
            } => PlanError::Time {
                needed_s: *needed_s,
                available_s: *available_s,
            }
            .fmt(f),
        }
    }
}

impl core::error::Error for FrameError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::range::Quantity;

    #[test]
    fn reason_of_a_plan_stays_the_reason_of_its_frame() {
        let stroke = StrokeTooShort {
            from_mm: -2.5,
            to_mm: 1.0,
            half_stroke_mm: 2.0,
        };
        assert_eq!(FrameError::from(stroke), FrameError::Stroke(stroke));
        let plan = PlanError::Stroke(stroke);
        assert_eq!(FrameError::from(plan), FrameError::Stroke(stroke));
        let range = Quantity::ExposureS.check(-1.0).unwrap_err();
        let plan = PlanError::OutOfRange(range);
        assert_eq!(FrameError::from(plan), FrameError::OutOfRange(range));
        assert_eq!(FrameError::from(range), FrameError::OutOfRange(range));
    }
}
