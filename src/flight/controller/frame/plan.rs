//! The plan of a frame, made at its trigger.

use super::{InFlight, Phase};
use crate::flight::controller::setup::Setup;
use crate::flight::controller::timing::LEAD_S;
use crate::flight::exposure::Exposure;
use crate::flight::fault::{Fault, Faults};
use crate::flight::frame_record::{Flag, Flags, Reason};
use crate::flight::stage::Travel;
use crate::flight::time::Time;
use crate::flight::vh::VhEstimate;

/// What a trigger asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Asked {
    pub(in super::super) sequence: u32,
    pub(in super::super) trigger: Time,
    /// V/H at the trigger.
    pub(in super::super) vh: Option<VhEstimate>,
    pub(in super::super) exposure: Exposure,
}

impl InFlight {
    /// A frame with a stage that moves.
    pub(in super::super) fn travelling(asked: Asked, setup: &Setup, travel: &Travel) -> Self {
        let [opening_mm, closing_mm] = [travel.plan.opening_mm, travel.plan.closing_mm];
        // The shutter's command must leave a latency before first light, and be known before that.
        let wait_s = (setup.settings.shutter_latency_s + LEAD_S - travel.opening_s).max(0.0);
        let mut frame = Self::new(asked, opening_mm, closing_mm - opening_mm, setup);
        frame.phase = Phase::Triggered {
            wait_s,
            opening_s: travel.opening_s,
        };
        if travel.off_centre_mm != 0.0 {
            frame.flags.insert(Flag::OffCentre);
        }
        frame
    }

    /// A frame of a TDI sensor, whose rows move: no stage, no run-up.
    pub(in super::super) fn of_rows(asked: Asked, setup: &Setup) -> Result<Self, Reason> {
        let motion = setup.camera.motion(&asked.exposure)?;
        let (opening_mm, travel_mm) = (motion.opening_offset_mm, motion.travel_mm);
        Ok(Self::new(asked, opening_mm, travel_mm, setup))
    }

    /// A frame without compensation for the reason of a fault; the stage stays at its place, mm.
    pub(in super::super) fn standing(
        asked: Asked,
        setup: &Setup,
        place_mm: f32,
        fault: Fault,
    ) -> Result<Self, Reason> {
        let checked = setup.camera.check_exposure_time(setup.exposure_s);
        checked.map_err(|_| Reason::OutsideLimits)?;
        let mut frame = Self::new(asked, place_mm, 0.0, setup);
        frame.flags = Flags::NONE;
        frame.flags.insert(Flag::NoCompensation);
        frame.faults.insert(fault);
        Ok(frame)
    }

    /// A frame that starts with the next round, and opens a latency later.
    fn new(asked: Asked, opening_mm: f32, travel_mm: f32, setup: &Setup) -> Self {
        let mut flags = Flags::NONE;
        if asked.vh.is_some_and(|vh| vh.extrapolated) {
            flags.insert(Flag::LastGoodVh);
        }
        Self {
            asked,
            planned_opening_mm: opening_mm,
            planned_travel_mm: travel_mm,
            faults: Faults::NONE,
            flags,
            phase: Phase::Triggered {
                wait_s: LEAD_S,
                opening_s: setup.settings.shutter_latency_s,
            },
        }
    }
}
