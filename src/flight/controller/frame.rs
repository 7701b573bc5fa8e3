//! The frame in flight: from its trigger to its record.

use crate::flight::exposure::Exposure;
use crate::flight::fault::Faults;
use crate::flight::frame_record::Flags;
use crate::flight::time::Time;
use crate::flight::vh::VhEstimate;

/// A frame from its trigger to its record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FrameInFlight {
    pub(super) sequence: u32,
    pub(super) trigger: Time,
    /// V/H at the trigger.
    pub(super) vh: Option<VhEstimate>,
    /// What is to be exposed.
    pub(super) exposure: Exposure,
    /// Δδ of the plan, mm.
    pub(super) planned_opening_mm: f32,
    /// δ of the plan, mm.
    pub(super) planned_travel_mm: f32,
    /// First light of the plan.
    pub(super) first_light: Time,
    /// Whether the shutter has been told to open.
    pub(super) is_commanded: bool,
    pub(super) opened: Option<Time>,
    pub(super) closed: Option<Time>,
    pub(super) faults: Faults,
    pub(super) flags: Flags,
}
