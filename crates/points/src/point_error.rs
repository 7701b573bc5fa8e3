//! Points that have no answer.

use thiserror::Error;

use crate::direction::Direction;

/// Reason why points have no answers.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PointError {
    /// A measured point is off the sensor.
    #[error("points[{index}] = ({}, {}) mm: off the sensor", point_mm[0], point_mm[1])]
    OffSensor {
        /// Place of the point.
        index: usize,
        /// The point, mm.
        point_mm: [f64; 2],
    },
    /// An ideal point has no measured one.
    #[error(
        "points[{index}] = ({}, {}) mm: no measured point on the sensor belongs to it",
        point_mm[0], point_mm[1]
    )]
    NoMeasured {
        /// Place of the point.
        index: usize,
        /// The point, mm.
        point_mm: [f64; 2],
    },
    /// A number of an index is no place of a frame.
    #[error("index[{at}] = {number}: must be a place among {count} frames, from 0")]
    NoPlace {
        /// Place of the number.
        at: usize,
        /// The number.
        number: i64,
        /// Frames that there are.
        count: usize,
    },
    /// The measured points of a frame cannot be referred to the calibration.
    #[error(
        "frame {sequence}: answer = 'measured-shifted' is not defined with the printed signs of the \
         focus shift"
    )]
    PrintedSign {
        /// Sequence number of the frame.
        sequence: u32,
    },
}

impl PointError {
    /// Returns the error of a point that has no answer.
    pub(crate) const fn of(direction: Direction, index: usize, point_mm: [f64; 2]) -> Self {
        match direction {
            Direction::Correct => Self::OffSensor { index, point_mm },
            Direction::Distort => Self::NoMeasured { index, point_mm },
        }
    }
}
