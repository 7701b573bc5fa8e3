//! Faults, and their consequences.

use super::setup::Setup;
use super::{Actions, Controller, act};
use crate::flight::event::{Action, Supply};
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
use crate::flight::time::Time;

impl Controller {
    /// Takes a fault that ends whatever the camera is doing: the stage is released, and an exposure
    /// that has not begun is called off. One that has begun is recorded when it ends.
    pub(super) fn fail(&mut self, setup: &Setup, fault: Fault, actions: &mut Actions) {
        if self.stage_fault(setup) == Some(fault) && self.stage.is_released() {
            // The same fault has released the stage before, and nothing has been asked of it since.
            if self.frame.is_in_flight() {
                self.frame.note(fault);
            }
            return;
        }
        self.frame.note(fault);
        self.stop(fault, actions);
    }

    /// Acts as [`Self::fail`], for a fault that is in a record already.
    pub(super) fn stop(&mut self, fault: Fault, actions: &mut Actions) {
        self.stage.fail(fault);
        act(actions, Action::Fault(fault));
        let unconfirmed = self.stage.unconfirmed.take();
        self.release(actions);
        if self.readiness.fail(fault) {
            self.refuse_frame(Reason::Fault(fault), actions);
        }
        if let Some(exposures) = unconfirmed {
            self.doubt(exposures, actions);
        }
    }

    /// Returns the fault of the stage that has not been cleared; a camera without a stage has none,
    /// even if its encoder has lost its place.
    pub(super) fn stage_fault(&self, setup: &Setup) -> Option<Fault> {
        self.stage.fault().filter(|_| setup.camera.has_stage())
    }

    /// Reports a fault that ends nothing.
    pub(super) fn report(&mut self, fault: Fault, actions: &mut Actions) {
        self.frame.note(fault);
        act(actions, Action::Fault(fault));
    }

    /// Restarts after a jump of the clock to a time: earlier measurements cannot be compared with
    /// later times.
    pub(super) fn restart_clock(&mut self, setup: &Setup, time: Time, actions: &mut Actions) {
        let before = self.readiness.last_event().unwrap_or(time);
        self.readiness.restart_clock(time);
        self.stage.restart_clock(time);
        self.frame.note(Fault::Clock);
        if self.frame.end_with_clock() {
            self.record_exposure(setup, [before, time], actions);
        }
        self.stage.forget_readings();
        self.aircraft.restart_clock();
        self.temperature.forget_time();
        self.stop(Fault::Clock, actions);
    }

    /// Takes a change of the supply: too low to move the stage, or good again.
    pub(super) fn supply(&mut self, setup: &Setup, supply: Supply, actions: &mut Actions) {
        let is_good = supply == Supply::Good;
        self.readiness.set_supply(is_good);
        if is_good {
            return;
        }
        if !setup.settings.encoder_survives_brown_out {
            self.stage.lose_place();
        }
        self.fail(setup, Fault::BrownOut, actions);
    }
}
