//! The passage of a frame's events from machine to machine: trigger, edges, rounds.

use super::frame::{Asked, Due, Plan};
use super::setup::Setup;
use super::timing::LEAD_S;
use super::{Actions, Controller, act};
use crate::flight::camera::Camera;
use crate::flight::event::{Action, ShutterEdge};
use crate::flight::exposure::Exposure;
use crate::flight::fault::{Fault, Faults};
use crate::flight::frame_record::{Flag, Reason};
use crate::flight::record_log::Numbered;
use crate::flight::time::Time;

impl Controller {
    /// Begins a frame, or refuses it; every trigger gets its record.
    pub(super) fn trigger(&mut self, setup: &Setup, trigger: Time, actions: &mut Actions) {
        let numbered = self.frame.kept.number(trigger);
        if let Numbered::Pending(sequence) = numbered {
            let admitted = self.readiness.admit(self.frame.is_in_flight());
            let begun = admitted.and_then(|fault| self.begin(setup, sequence, trigger, fault));
            let Err(reason) = begun else {
                return;
            };
            let kept = &mut self.frame.kept;
            kept.refuse(sequence, trigger, reason, Faults::NONE);
        }
        let (Numbered::Pending(sequence) | Numbered::Full(sequence)) = numbered;
        act(actions, Action::FrameReady(sequence));
    }

    /// Begins a frame with compensation, or without it because of a fault or for want of V/H.
    fn begin(
        &mut self,
        setup: &Setup,
        sequence: u32,
        trigger: Time,
        fault: Option<Fault>,
    ) -> Result<(), Reason> {
        let focus_shift_um = self.focus_shift_with(setup.camera);
        setup.camera.check_focus_shift(focus_shift_um)?;
        let held = self.aircraft.vh.held(trigger);
        let vh = held.map(|held| held.estimate(0.0));
        let vh_per_s = vh.map_or(0.0, |vh| vh.vh_per_s);
        let mut asked = Asked {
            sequence,
            trigger,
            vh,
            exposure: Exposure {
                focus_shift_um,
                ..setup.exposure(vh_per_s, self.exposure_s)
            },
        };
        let plan = match fault.or(vh.is_none().then_some(Fault::VhLost)) {
            None if setup.camera.has_stage() => {
                let standing = self.stage.setpoint(trigger).ok_or(Reason::NotArmed)?;
                let (from_mm, margin_s) = (standing.offset_mm, setup.margin_s());
                let travel = setup.camera.travel(from_mm, &asked.exposure, margin_s)?;
                let plan = Plan::of_stage(&asked, setup, &travel);
                self.stage.wait_for(travel.profile);
                plan
            }
            None => Plan::of_rows(&asked, setup)?,
            Some(fault) => Plan::standing(&asked, setup, self.stage.place_mm(trigger), fault)?,
        };
        // The record states σ and age at the middle of the exposure, where V/H is in use.
        let ahead_s = plan.first_light_s() + 0.5 * asked.exposure.exposure_s;
        asked.vh = held.map(|held| held.estimate(ahead_s));
        self.frame.begin(asked, &plan);
        let table = setup.camera.focus_table();
        self.frame.flag_all(self.temperature.flags(table, trigger));
        Ok(())
    }

    /// Focus shift of the frames to come with a camera, µm: by its table, and as it was told.
    pub(super) fn focus_shift_with(&self, camera: &Camera) -> f32 {
        self.focus_shift_um + self.temperature.focus_shift_um(camera.focus_table())
    }

    /// Takes an edge of the shutter's sensor.
    pub(super) fn shutter_edge(
        &mut self,
        setup: &Setup,
        time: Time,
        edge: ShutterEdge,
        actions: &mut Actions,
    ) {
        let tolerance_s = setup.settings.shutter_tolerance_s;
        let seen = self.frame.see_edge(time, edge, tolerance_s);
        if seen.is_first_light {
            self.stage.track_mut().keep_from(time);
        }
        if seen.is_unasked && !setup.camera.has_stage() {
            // The clock of the rows has not been told to start.
            self.frame.flag(Flag::PlannedMotion);
            self.frame.flag(Flag::StaticCorrection);
        }
        if let Some(fault) = seen.fault {
            act(actions, Action::Fault(fault));
        }
        if seen.is_to_close {
            act(actions, Action::CloseShutter);
        }
    }

    /// Returns `true` if the shutter may be told now to open at a time, for an exposure, s: a
    /// second look at stage and time, of other numbers and code than the first.
    pub(in super::super) fn may_open(
        &self,
        setup: &Setup,
        now: Time,
        (at, exposure_s): (Time, f32),
    ) -> bool {
        at <= now.plus_s(LEAD_S) && self.stage.moves_as_set(setup, now, exposure_s)
    }

    /// Ends the frame whose shutter has been told to open and must not.
    pub(in super::super) fn refuse_opening(&mut self, setup: &Setup, now: Time) -> Actions {
        let mut actions = Actions::new();
        self.call_off(setup, now, Reason::NotAtSpeed, &mut actions);
        actions
    }

    /// Carries out the action that is due for the frame in flight.
    pub(super) fn look_after_frame(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        match self.frame.look(now, setup, &self.stage) {
            Due::Nothing => {}
            Due::Open {
                at,
                exposure_s,
                rows_mm_s,
            } => {
                if !setup.camera.has_stage() {
                    let speed_mm_s = rows_mm_s;
                    act(actions, Action::ClockRows { at, speed_mm_s });
                }
                act(actions, Action::OpenShutter { at, exposure_s });
            }
            Due::CallOff(reason) => {
                if reason == Reason::ShutterMissing {
                    self.report(Fault::ShutterMissing, actions);
                }
                self.call_off(setup, now, reason, actions);
            }
            Due::Close => {
                act(actions, Action::Fault(Fault::ShutterLong));
                act(actions, Action::CloseShutter);
            }
            Due::GivenUp => {
                self.record_exposure(setup, [now; 2], actions);
                self.stop(Fault::ShutterLong, actions);
            }
            Due::Record => self.record_exposure(setup, [now; 2], actions),
        }
    }

    /// Records the exposure in flight, and ends it; the stage returns. The first time is the last
    /// by the clock of the exposure, the second the present one.
    pub(super) fn record_exposure(
        &mut self,
        setup: &Setup,
        [until, now]: [Time; 2],
        actions: &mut Actions,
    ) {
        let recorded = self
            .frame
            .record(setup, &self.stage, &mut self.aircraft, until);
        if let Some(recorded) = recorded {
            act(actions, Action::FrameReady(recorded.sequence));
            self.stage.track_mut().keep_latest();
            self.await_crossings(setup, now, &recorded);
            self.go_back(setup, now, actions);
        }
    }

    /// Ends the frame in flight before first light; the stage returns.
    pub(super) fn call_off(
        &mut self,
        setup: &Setup,
        now: Time,
        reason: Reason,
        actions: &mut Actions,
    ) {
        self.refuse_frame(reason, actions);
        self.go_back(setup, now, actions);
    }

    /// Ends the frame in flight, if it is before first light.
    pub(super) fn refuse_frame(&mut self, reason: Reason, actions: &mut Actions) {
        if let Some((sequence, is_told)) = self.frame.call_off(reason) {
            if is_told {
                act(actions, Action::CloseShutter);
            }
            act(actions, Action::FrameReady(sequence));
        }
    }
}
