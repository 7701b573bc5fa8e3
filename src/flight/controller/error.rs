//! The error of a camera that cannot be flown.

use core::fmt;

use crate::flight::camera::FrameError;
use crate::geometry::range::OutOfRange;

/// The reason why a camera cannot be flown.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ControllerError {
    /// A setting is outside its range.
    Settings(OutOfRange),
    /// The mechanism cannot make any travel within the camera's limits, or not between two
    /// triggers; or the camera has no fitted model, and is to be corrected by it.
    Travel(FrameError),
}

impl fmt::Display for ControllerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Settings(error) => error.fmt(f),
            Self::Travel(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ControllerError {}
