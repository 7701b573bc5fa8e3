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
    pub(super) fn fail(&mut self, now: Time, fault: Fault, actions: &mut Actions) {
        self.note(fault);
        self.is_place_lost |= fault == Fault::Encoder;
        if let State::Standby | State::Fault(_) = self.state {
            return;
        }
        act(actions, Action::Fault(fault));
        self.release(actions);
        if let Some(frame) = self.frame
            && frame.opened.is_none()
        {
            self.refuse_frame(now, Reason::Fault(fault), actions);
        }
        self.state = State::Fault(fault);
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
        if let Motion::Profile { .. } = self.motion {
            act(actions, Action::ReleaseStage);
        }
        self.motion = Motion::Released;
        self.exercise = 0;
        self.following.clear();
        self.watch = StageWatch::new();
        self.standing_since = None;
    }

    /// The frame in flight ends before the shutter has opened; the stage goes back.
    pub(super) fn call_off(&mut self, now: Time, reason: Reason, actions: &mut Actions) {
        self.refuse_frame(now, reason, actions);
        self.go_back(now, actions);
    }

    fn refuse_frame(&mut self, now: Time, reason: Reason, actions: &mut Actions) {
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
        let _ = now;
    }

    /// After a frame: back to the waiting place, where there is a stage with force on it.
    pub(super) fn go_back(&mut self, now: Time, actions: &mut Actions) {
        if let State::Fault(_) = self.state {
            return;
        }
        match &self.motion {
            Motion::Released if core::mem::take(&mut self.is_disarming) => self.stand_by(actions),
            Motion::Released => self.state = self.ready(),
            Motion::Profile { .. } => match self.way_back(now) {
                Some(profile) => {
                    self.motion = Motion::Profile {
                        profile,
                        since: now,
                    };
                    self.state = State::FlyBack;
                }
                // The set point is not a number.
                None => self.fail(now, Fault::Drive, actions),
            },
        }
    }

    pub(super) fn supply(&mut self, now: Time, supply: Supply, actions: &mut Actions) {
        self.is_supply_good = supply == Supply::Good;
        if !self.is_supply_good {
            self.fail(now, Fault::BrownOut, actions);
        }
    }
}
