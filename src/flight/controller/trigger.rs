//! A trigger: a frame begins, or is refused.

use super::frame::FrameInFlight;
use super::motion::Motion;
use super::state::State;
use super::timing::{EXERCISE_REACH, LEAD_S, TICK_S};
use super::{Actions, Controller, ControllerError};
use crate::flight::camera::{Camera, FrameError};
use crate::flight::exposure::Exposure;
use crate::flight::fault::{Fault, Faults};
use crate::flight::frame_record::{Flag, Flags, Reason};
use crate::flight::record_log::Numbered;
use crate::flight::settings::FlightSettings;
use crate::flight::stage::{PlanError, Profile, Setpoint};
use crate::flight::time::Time;
use crate::flight::vh::VhEstimate;

impl Controller {
    /// Every trigger gets a number, and with it a record.
    pub(super) fn trigger(&mut self, time: Time, actions: &mut Actions) {
        self.counts.triggers = self.counts.triggers.saturating_add(1);
        let sequence = match self.records.number(time, self.calibration_crc) {
            Numbered::Pending(sequence) => sequence,
            Numbered::Full(sequence) => {
                self.announce_refused(sequence, actions);
                return;
            }
        };
        let reason = match self.state {
            State::Armed => match self.start_compensated(sequence, time) {
                Ok(()) => return,
                Err(reason) => reason,
            },
            State::Degraded(fault) => match self.start_standing(sequence, time, fault) {
                Ok(()) => return,
                Err(reason) => reason,
            },
            State::Standby => Reason::NotArmed,
            State::Fault(fault) => Reason::Fault(fault),
            State::FlyBack if self.arming.is_some() => Reason::NotArmed,
            State::RunUp | State::Tracking | State::Exposing | State::FlyBack => Reason::Overlap,
        };
        self.refuse(sequence, time, reason, Faults::NONE, actions);
    }

    /// The exposure that a V/H asks for.
    fn exposure(&self, vh_per_s: f32) -> Exposure {
        exposure(&self.settings, vh_per_s, self.exposure_s)
    }

    /// The stage begins to move.
    fn start_compensated(&mut self, sequence: u32, trigger: Time) -> Result<(), Reason> {
        let Some(vh) = self.vh.estimate(trigger) else {
            return self.start_standing(sequence, trigger, Fault::VhLost);
        };
        let exposure = self.exposure(vh.vh_per_s);
        if !self.camera.has_stage() {
            return self.start_rows(sequence, trigger, vh, exposure);
        }
        let standing = self.setpoint(trigger).ok_or(Reason::NotArmed)?;
        let travel = self
            .camera
            .travel(standing.offset_mm, &exposure, self.margin_s())
            .map_err(reason_of)?;
        // The shutter's command must leave a latency before first light, and be known before that.
        let wait_s = (self.settings.shutter_latency_s + LEAD_S - travel.opening_s).max(0.0);
        let mut flags = Flags::NONE;
        if travel.off_centre_mm != 0.0 {
            flags.insert(Flag::OffCentre);
        }
        if vh.extrapolated {
            flags.insert(Flag::LastGoodVh);
        }
        self.begin(FrameInFlight {
            planned_opening_mm: travel.plan.opening_mm,
            planned_travel_mm: travel.plan.closing_mm - travel.plan.opening_mm,
            start: Some([wait_s, travel.opening_s]),
            flags,
            ..FrameInFlight::new(sequence, trigger, Some(vh), exposure)
        });
        self.state = State::RunUp;
        self.motion = Some(Motion {
            profile: travel.profile,
            // Until the next round, which may be late.
            since: Time::from_us(u64::MAX),
        });
        Ok(())
    }

    /// The rows of a TDI sensor begin to move: no stage, no run-up.
    fn start_rows(
        &mut self,
        sequence: u32,
        trigger: Time,
        vh: VhEstimate,
        exposure: Exposure,
    ) -> Result<(), Reason> {
        let motion = self.camera.motion(&exposure).map_err(reason_of)?;
        let mut flags = Flags::NONE;
        if vh.extrapolated {
            flags.insert(Flag::LastGoodVh);
        }
        self.begin(FrameInFlight {
            planned_opening_mm: motion.opening_offset_mm,
            planned_travel_mm: motion.travel_mm,
            start: Some([LEAD_S, self.settings.shutter_latency_s]),
            flags,
            ..FrameInFlight::new(sequence, trigger, Some(vh), exposure)
        });
        self.state = State::RunUp;
        Ok(())
    }

    /// The stage stays where it is, for the reason of a fault.
    fn start_standing(&mut self, sequence: u32, trigger: Time, fault: Fault) -> Result<(), Reason> {
        let vh = self.vh.estimate(trigger);
        let exposure = self.exposure(vh.map_or(0.0, |vh| vh.vh_per_s));
        self.camera
            .check_exposure_time(self.exposure_s)
            .map_err(|_| Reason::OutsideLimits)?;
        let mut flags = Flags::NONE;
        flags.insert(Flag::NoCompensation);
        let mut faults = Faults::NONE;
        faults.insert(fault);
        let place = match self.setpoint(trigger) {
            Some(setpoint) => setpoint.offset_mm,
            None => self.track.last().map_or(0.0, |reading| reading.offset_mm),
        };
        self.begin(FrameInFlight {
            planned_opening_mm: place,
            start: Some([LEAD_S, self.settings.shutter_latency_s]),
            faults,
            flags,
            ..FrameInFlight::new(sequence, trigger, vh, exposure)
        });
        self.state = State::RunUp;
        Ok(())
    }

    /// The first round after the trigger: from here on the stage moves, at the same time after every trigger unless
    /// the round is late.
    pub(super) fn start(&mut self, now: Time) {
        let Some(frame) = &mut self.frame else {
            return;
        };
        if let Some([wait_s, opening_s]) = frame.start.take() {
            let since = now.max(frame.trigger.plus_s(TICK_S)).plus_s(wait_s);
            frame.first_light = since.plus_s(opening_s);
            if let (Some(motion), State::RunUp, false) = (
                &mut self.motion,
                self.state,
                frame.flags.contains(Flag::NoCompensation),
            ) {
                motion.since = since;
            }
        }
    }

    fn begin(&mut self, mut frame: FrameInFlight) {
        for fault in core::mem::take(&mut self.faults).iter() {
            frame.faults.insert(fault);
        }
        self.frame = Some(frame);
    }

    /// How much longer than the exposure the stage stays at speed.
    pub(super) fn margin_s(&self) -> f32 {
        margin_s(&self.settings)
    }

    /// Where the stage waits for the next trigger: at the place for the V/H there is, or, where there is none, for the
    /// largest of the camera's limits.
    pub(super) fn waiting_place_mm(&self, now: Time) -> Result<f32, FrameError> {
        let [_, most] = self.camera.limits().vh_per_s;
        let at = |vh_per_s| {
            self.camera
                .waiting_place_mm(&self.exposure(vh_per_s), self.margin_s())
        };
        match self.vh.estimate(now) {
            Some(vh) => at(vh.vh_per_s).or_else(|_| at(most)),
            None => at(most),
        }
    }

    /// The way to the waiting place, or to the next end of the exercise, from wherever the stage is.
    pub(super) fn way_back(&self, now: Time) -> Option<Profile> {
        let from = self.setpoint(now).unwrap_or_else(|| Setpoint {
            offset_mm: self.track.last().map_or(0.0, |reading| reading.offset_mm),
            ..Setpoint::default()
        });
        let reach_mm = EXERCISE_REACH * self.camera.calibration().record().stroke_mm;
        let place_mm = match self.arming {
            None | Some(0) => self.waiting_place_mm(now).unwrap_or(0.0),
            Some(ways) if ways % 2 == 0 => -reach_mm,
            Some(_) => reach_mm,
        };
        self.camera.stage().reposition(from, place_mm).ok()
    }
}

/// Whether the mechanism is back before the next trigger, at the largest V/H of the camera's limits.
pub(super) fn check_interval(
    camera: &Camera,
    settings: &FlightSettings,
) -> Result<(), ControllerError> {
    let available_s = settings.trigger_interval_s;
    if available_s == 0.0 || !camera.has_stage() {
        return Ok(());
    }
    let [_, most] = camera.limits().vh_per_s;
    let exposure = exposure(settings, most, settings.exposure_s);
    let margin_s = margin_s(settings);
    let needed = || {
        let place_mm = camera.waiting_place_mm(&exposure, margin_s)?;
        let travel = camera.travel(place_mm, &exposure, margin_s)?;
        let cycle_s = camera.stage().cycle_s(&travel, place_mm)?;
        let before_s = TICK_S + (settings.shutter_latency_s + LEAD_S - travel.opening_s).max(0.0);
        Ok(before_s + cycle_s)
    };
    let needed_s = needed().map_err(ControllerError::Travel)?;
    if needed_s <= available_s {
        Ok(())
    } else {
        Err(ControllerError::Travel(
            PlanError::Time {
                needed_s,
                available_s,
            }
            .into(),
        ))
    }
}

/// The exposure that a V/H asks for.
fn exposure(settings: &FlightSettings, vh_per_s: f32, exposure_s: f32) -> Exposure {
    Exposure {
        direction: settings.direction,
        ..Exposure::new(vh_per_s, exposure_s)
    }
}

/// How much longer than the exposure the stage stays at speed.
fn margin_s(settings: &FlightSettings) -> f32 {
    2.0 * settings.shutter_tolerance_s + TICK_S
}

/// Why a frame that cannot be planned is refused.
fn reason_of(error: FrameError) -> Reason {
    match error {
        FrameError::Stroke(_) => Reason::Stroke,
        FrameError::Speed { .. } => Reason::Speed,
        FrameError::OutOfRange(_) | FrameError::NotFitted | FrameError::Time { .. } => {
            Reason::OutsideLimits
        }
    }
}
