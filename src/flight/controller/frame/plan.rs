//! The plan of a frame, made at its trigger.

use crate::flight::controller::setup::Setup;
use crate::flight::controller::timing::{LEAD_S, TICK_S};
use crate::flight::exposure::Exposure;
use crate::flight::fault::{Fault, Faults};
use crate::flight::frame_record::{Flag, Flags, Reason};
use crate::flight::stage::Travel;
use crate::flight::time::Time;
use crate::flight::vh::VhEstimate;

/// Inputs of a frame at its trigger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Asked {
    pub(in super::super) sequence: u32,
    pub(in super::super) trigger: Time,
    /// V/H at the trigger.
    pub(in super::super) vh: Option<VhEstimate>,
    pub(in super::super) exposure: Exposure,
}

/// Plan of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Plan {
    /// Δδ, mm.
    pub(super) opening_mm: f32,
    /// δ, mm.
    pub(super) travel_mm: f32,
    /// From the next round to the start of the stage, s.
    pub(super) wait_s: f32,
    /// From the start of the stage to first light, s.
    pub(super) opening_s: f32,
    pub(super) faults: Faults,
    pub(super) flags: Flags,
}

impl Plan {
    /// Returns the plan for a stage that moves.
    pub(in super::super) fn of_stage(asked: &Asked, setup: &Setup, travel: &Travel) -> Self {
        let [opening_mm, closing_mm] = [travel.plan.opening_mm, travel.plan.closing_mm];
        let mut plan = Self::new(asked, setup, opening_mm, closing_mm - opening_mm);
        // The shutter's command must leave a latency before first light, and be known before that.
        plan.wait_s = (setup.settings.shutter_latency_s + LEAD_S - travel.opening_s).max(0.0);
        plan.opening_s = travel.opening_s;
        if travel.off_centre_mm != 0.0 {
            plan.flags.insert(Flag::OffCentre);
        }
        plan
    }

    /// Returns the plan for the rows of a TDI sensor, without stage and run-up.
    pub(in super::super) fn of_rows(asked: &Asked, setup: &Setup) -> Result<Self, Reason> {
        let motion = setup.camera.motion(&asked.exposure)?;
        let (opening_mm, travel_mm) = (motion.opening_offset_mm, motion.travel_mm);
        Ok(Self::new(asked, setup, opening_mm, travel_mm))
    }

    /// Returns a plan without compensation because of a fault: the stage stays at its place, mm.
    pub(in super::super) fn standing(
        asked: &Asked,
        setup: &Setup,
        place_mm: f32,
        fault: Fault,
    ) -> Result<Self, Reason> {
        let checked = setup.camera.check_exposure_time(asked.exposure.exposure_s);
        checked.map_err(|_| Reason::OutsideLimits)?;
        let mut plan = Self::new(asked, setup, place_mm, 0.0);
        plan.flags = Flags::NONE;
        plan.flags.insert(Flag::NoCompensation);
        plan.faults.insert(fault);
        Ok(plan)
    }

    /// Time from the trigger to first light, s, if the next round is punctual.
    pub(in super::super) fn first_light_s(&self) -> f32 {
        TICK_S + self.wait_s + self.opening_s
    }

    /// Returns a plan in which the shutter opens a latency after the next round.
    fn new(asked: &Asked, setup: &Setup, opening_mm: f32, travel_mm: f32) -> Self {
        let mut flags = Flags::NONE;
        if asked.vh.is_some_and(|vh| vh.extrapolated) {
            flags.insert(Flag::LastGoodVh);
        }
        Self {
            opening_mm,
            travel_mm,
            wait_s: LEAD_S,
            opening_s: setup.settings.shutter_latency_s,
            faults: Faults::NONE,
            flags,
        }
    }
}
