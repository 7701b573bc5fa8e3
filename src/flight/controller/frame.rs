//! The frame in flight: from its trigger to its record.

use crate::flight::exposure::Exposure;
use crate::flight::fault::Faults;
use crate::flight::frame_record::Flags;
use crate::flight::time::Time;
use crate::flight::vh::VhEstimate;
use crate::geometry::principal_point::PrincipalPointMotion;

/// How the stage moved in an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeasuredMotion {
    pub(super) motion: PrincipalPointMotion,
    /// σ of its centroid, mm.
    pub(super) sigma_mm: f32,
    /// How far the stage left a straight line in time, mm.
    pub(super) wander_mm: f32,
}

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
    /// Until the next round: after so long the stage starts, s, and the shutter opens, s after that.
    pub(super) start: Option<[f32; 2]>,
    /// First light of the plan.
    pub(super) first_light: Time,
    /// Whether the shutter has been told to open.
    pub(super) is_commanded: bool,
    pub(super) opened: Option<Time>,
    pub(super) closed: Option<Time>,
    /// How the stage moved, once that has been worked out.
    pub(super) measured: Option<MeasuredMotion>,
    /// When the shutter was told to close because it had been open for too long.
    pub(super) told_to_close: Option<Time>,
    /// Last light was not seen.
    pub(super) is_end_assumed: bool,
    pub(super) faults: Faults,
    pub(super) flags: Flags,
}

impl FrameInFlight {
    /// A frame of which no more is known than this; nothing moves.
    pub(super) const fn new(
        sequence: u32,
        trigger: Time,
        vh: Option<VhEstimate>,
        exposure: Exposure,
    ) -> Self {
        Self {
            sequence,
            trigger,
            vh,
            exposure,
            planned_opening_mm: 0.0,
            planned_travel_mm: 0.0,
            start: None,
            first_light: trigger,
            is_commanded: false,
            opened: None,
            closed: None,
            measured: None,
            told_to_close: None,
            is_end_assumed: false,
            faults: Faults::NONE,
            flags: Flags::NONE,
        }
    }
}
