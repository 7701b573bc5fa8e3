//! What somebody wants.

use super::motion::Motion;
use super::state::State;
use super::timing::EXERCISE_WAYS;
use super::{Actions, Controller, act};
use crate::flight::event::{Action, Command};
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
use crate::flight::stage_watch::StageWatch;
use crate::flight::time::Time;

impl Controller {
    pub(super) fn obey(&mut self, now: Time, command: Command, actions: &mut Actions) {
        match command {
            Command::Arm => self.arm(now, actions),
            Command::Disarm => self.disarm(now, actions),
            Command::ClearFault => self.clear_fault(actions),
            // One outside the camera's limits leads to the refusal of every trigger.
            Command::Exposure(exposure_s) => self.exposure_s = exposure_s,
        }
    }

    fn arm(&mut self, now: Time, actions: &mut Actions) {
        match self.state {
            State::Standby if !self.is_supply_good => act(actions, Action::Fault(Fault::BrownOut)),
            State::Standby if self.degraded.is_some_and(is_of_the_stage) => {
                self.state = self.ready();
            }
            State::Standby => {
                self.exercise = EXERCISE_WAYS;
                self.resume(now, actions);
            }
            // On its way to standby.
            _ => self.is_disarming = false,
        }
    }

    fn disarm(&mut self, now: Time, actions: &mut Actions) {
        match self.state {
            State::Standby => {}
            State::Armed | State::Degraded(_) => self.stand_by(actions),
            State::RunUp | State::Tracking => {
                self.is_disarming = true;
                self.call_off(now, Reason::Disarmed, actions);
            }
            State::Exposing | State::FlyBack | State::Fault(_) => self.is_disarming = true,
        }
    }

    /// To standby, from a fault or from flying without compensation because of one. An exposure goes on.
    fn clear_fault(&mut self, actions: &mut Actions) {
        if self.frame.is_some() {
            return;
        }
        if let State::Fault(_) | State::Degraded(_) | State::Standby = self.state {
            self.degraded = None;
            self.is_place_lost = false;
            self.is_disarming = false;
            self.stand_by(actions);
        }
    }

    pub(super) fn stand_by(&mut self, actions: &mut Actions) {
        self.release(actions);
        self.state = State::Standby;
    }

    /// Force on the stage, and to its waiting place.
    pub(super) fn resume(&mut self, now: Time, actions: &mut Actions) {
        self.degraded = None;
        self.following.clear();
        self.watch = StageWatch::new();
        if !self.camera.has_stage() {
            self.state = State::Armed;
            return;
        }
        let Some(profile) = self.way_back(now) else {
            self.state = State::Fault(Fault::Encoder);
            act(actions, Action::Fault(Fault::Encoder));
            return;
        };
        self.motion = Motion::Profile {
            profile,
            since: now,
        };
        self.state = State::FlyBack;
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
