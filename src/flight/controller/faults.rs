//! Something goes wrong.

use super::frame::FrameInFlight;
use super::motion::Motion;
use super::state::State;
use super::{Actions, Controller, act};
use crate::flight::event::{Action, Supply};
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
use crate::flight::stage_watch::StageWatch;
use crate::flight::time::Time;

impl Controller {
    /// A fault that ends whatever the camera is doing: no force on the stage, no exposure that has not begun. One
    /// that has begun is recorded when it ends.
    pub(super) fn fail(&mut self, fault: Fault, actions: &mut Actions) {
        if self.stage_fault == Some(fault) && self.motion.is_none() {
            // It has been so since, and nothing has been asked of the stage.
            self.change_frame(|frame| frame.faults.insert(fault));
            return;
        }
        self.note(fault);
        self.stop(fault, actions);
    }

    /// As [`Self::fail`], of a fault that is in a record already.
    pub(super) fn stop(&mut self, fault: Fault, actions: &mut Actions) {
        if is_of_the_stage(fault) && self.camera.has_stage() {
            // Where it is the encoder that is the wrong way round, it has counted to a place where the stage is not: at
            // a standstill that looks like a stage that runs away.
            self.is_place_lost |= matches!(
                fault,
                Fault::Encoder | Fault::WrongDirection | Fault::Runaway
            );
            let first = self.stage_fault.unwrap_or(fault);
            self.stage_fault = Some(if fault == Fault::Encoder {
                fault
            } else {
                first
            });
        }
        act(actions, Action::Fault(fault));
        self.release(actions);
        if let State::Standby | State::Fault(_) = self.state {
            return;
        }
        if let Some(frame) = self.frame
            && frame.opened.is_none()
        {
            self.refuse_frame(Reason::Fault(fault), actions);
        }
        self.state = State::Fault(fault);
    }

    /// Events came faster than the control loop takes them.
    pub(super) fn lose(&mut self, events: u32, actions: &mut Actions) {
        self.counts.lost_events = self.counts.lost_events.saturating_add(events);
        self.report(Fault::Overload, actions);
    }

    /// A fault that goes into the record of the frame in flight, or of the next.
    pub(super) fn note(&mut self, fault: Fault) {
        match &mut self.frame {
            Some(frame) => frame.faults.insert(fault),
            None => self.faults.insert(fault),
        }
    }

    /// No force on the stage.
    pub(super) fn release(&mut self, actions: &mut Actions) {
        if self.motion.take().is_some() {
            act(actions, Action::ReleaseStage);
        }
        self.arming = None;
        self.following.clear();
        self.watch = StageWatch::new();
        self.standing_since = None;
    }

    /// The frame in flight ends before the shutter has opened; the stage goes back.
    pub(super) fn call_off(&mut self, now: Time, reason: Reason, actions: &mut Actions) {
        self.refuse_frame(reason, actions);
        self.go_back(now, actions);
    }

    fn refuse_frame(&mut self, reason: Reason, actions: &mut Actions) {
        if let Some(frame) = self.frame.take() {
            if frame.is_commanded {
                act(actions, Action::CloseShutter);
            }
            let FrameInFlight {
                sequence,
                trigger,
                faults,
                ..
            } = frame;
            self.refuse(sequence, trigger, reason, faults, actions);
        }
    }

    /// After a frame: back to the waiting place, where there is a stage with force on it.
    pub(super) fn go_back(&mut self, now: Time, actions: &mut Actions) {
        if let State::Fault(_) = self.state {
            return;
        }
        if self.motion.is_none() {
            if core::mem::take(&mut self.is_disarming) {
                self.stand_by(actions);
            } else {
                self.state = self.ready(now);
            }
            return;
        }
        match self.way_back(now) {
            Some(profile) => {
                self.motion = Some(Motion {
                    profile,
                    since: now,
                });
                self.state = State::FlyBack;
            }
            // The set point is not a number.
            None => self.fail(Fault::Drive, actions),
        }
    }

    pub(super) fn supply(&mut self, supply: Supply, actions: &mut Actions) {
        self.is_supply_good = supply == Supply::Good;
        if self.is_supply_good {
            return;
        }
        if !self.settings.encoder_survives_brown_out && self.camera.has_stage() {
            self.is_place_lost = true;
            self.stage_fault = Some(Fault::Encoder);
        }
        self.fail(Fault::BrownOut, actions);
    }
}

/// Faults after which the stage is left alone until they are cleared.
const fn is_of_the_stage(fault: Fault) -> bool {
    matches!(
        fault,
        Fault::Stall
            | Fault::Runaway
            | Fault::WrongDirection
            | Fault::LimitSwitch
            | Fault::Encoder
            | Fault::Drive
    )
}
