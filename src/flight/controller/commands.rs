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
            Command::Referenced => self.referenced(),
            // One outside the camera's limits leads to the refusal of every trigger.
            Command::Exposure(exposure_s) => self.exposure_s = exposure_s,
        }
    }

    fn arm(&mut self, now: Time, actions: &mut Actions) {
        match self.state {
            State::Standby if !self.is_supply_good => act(actions, Action::Fault(Fault::BrownOut)),
            State::Standby => self.resume(now, actions),
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

    /// To standby, from a fault or from flying without compensation because of one. An exposure goes on. A place that
    /// is lost stays so.
    fn clear_fault(&mut self, actions: &mut Actions) {
        if self.frame.is_some() {
            return;
        }
        if let State::Fault(_) | State::Degraded(_) | State::Standby = self.state {
            self.stage_fault = self.is_place_lost.then_some(Fault::Encoder);
            self.rounds.forget_overload();
            self.is_disarming = false;
            self.stand_by(actions);
        }
    }

    /// The encoder counts from the calibrated position again; in standby alone, where nothing follows from it at once.
    fn referenced(&mut self) {
        if self.state == State::Standby {
            self.is_place_lost = false;
            self.track.clear();
            self.following.clear();
            self.stage_fault = self.stage_fault.filter(|fault| *fault != Fault::Encoder);
        }
    }

    pub(super) fn stand_by(&mut self, actions: &mut Actions) {
        self.release(actions);
        self.state = State::Standby;
    }

    /// Force on the stage, to and fro, and to its waiting place; where there is none, or something is wrong with it,
    /// ready without.
    pub(super) fn resume(&mut self, now: Time, actions: &mut Actions) {
        if !self.camera.has_stage() || self.stage_fault.is_some() {
            self.state = self.ready(now);
            return;
        }
        self.arming = Some(EXERCISE_WAYS);
        self.following.clear();
        self.watch = StageWatch::new();
        self.last_reading = now;
        match self.way_back(now) {
            Some(profile) => {
                self.motion = Some(Motion {
                    profile,
                    since: now,
                });
                self.state = State::FlyBack;
            }
            // The reading is not a number, or the stage's end is not.
            None => self.fail(Fault::Encoder, actions),
        }
    }
}
