//! Faults, and what they end.

use super::{Actions, Controller, act};
use crate::flight::event::{Action, Supply};
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
use crate::flight::time::Time;

impl Controller {
    /// A fault that ends whatever the camera is doing: no force on the stage, no exposure that has not begun. One
    /// that has begun is recorded when it ends.
    pub(super) fn fail(&mut self, fault: Fault, actions: &mut Actions) {
        if self.stage.fault() == Some(fault) && self.stage.is_released() {
            // It has been so since, and nothing has been asked of the stage.
            if self.frame.is_in_flight() {
                self.frame.note(fault);
            }
            return;
        }
        self.frame.note(fault);
        self.stop(fault, actions);
    }

    /// As [`Self::fail`], of a fault that is in a record already.
    pub(super) fn stop(&mut self, fault: Fault, actions: &mut Actions) {
        if self.setup.camera.has_stage() {
            self.stage.fail(fault);
        }
        act(actions, Action::Fault(fault));
        self.release(actions);
        if self.readiness.fail(fault) {
            self.refuse_frame(Reason::Fault(fault), actions);
        }
    }

    /// A fault that ends nothing.
    pub(super) fn report(&mut self, fault: Fault, actions: &mut Actions) {
        self.frame.note(fault);
        act(actions, Action::Fault(fault));
    }

    /// The clock has jumped to a time: what was measured so far has nothing to do with the times to
    /// come.
    pub(super) fn restart_clock(&mut self, time: Time, actions: &mut Actions) {
        self.readiness.restart_clock(time);
        self.stage.restart_clock(time);
        self.frame.note(Fault::Clock);
        if self.frame.end_with_clock() {
            self.record_exposure(time, actions);
        }
        self.stage.forget_readings();
        self.stop(Fault::Clock, actions);
    }

    /// The supply has fallen too low to move the stage, or is good again.
    pub(super) fn supply(&mut self, supply: Supply, actions: &mut Actions) {
        let is_good = supply == Supply::Good;
        self.readiness.set_supply(is_good);
        if is_good {
            return;
        }
        if !self.setup.settings.encoder_survives_brown_out && self.setup.camera.has_stage() {
            self.stage.lose_place();
        }
        self.fail(Fault::BrownOut, actions);
    }
}
