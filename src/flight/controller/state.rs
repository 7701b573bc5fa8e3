//! States of the camera.

use core::fmt;

use crate::flight::fault::Fault;

/// State of the camera, as it is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum State {
    /// Triggers are refused; the stage is left alone.
    Standby,
    /// The stage waits at its starting place; a trigger will be obeyed.
    Armed,
    /// Armed without compensation: the stage stands still while the shutter is open.
    Degraded(Fault),
    /// The stage accelerates and settles.
    RunUp,
    /// The stage is at speed, the shutter is about to open.
    Tracking,
    /// The shutter is open.
    Exposing,
    /// The stage stops and returns.
    FlyBack,
    /// A fault has occurred; the stage is released.
    Fault(Fault),
}

impl State {
    /// The name in documents and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Standby => "standby",
            Self::Armed => "armed",
            Self::Degraded(_) => "degraded",
            Self::RunUp => "run-up",
            Self::Tracking => "tracking",
            Self::Exposing => "exposing",
            Self::FlyBack => "fly-back",
            Self::Fault(_) => "fault",
        }
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Degraded(fault) | Self::Fault(fault) => write!(f, "{}: {fault}", self.name()),
            _ => f.write_str(self.name()),
        }
    }
}
