//! Ways of the stage between frames, and the readiness that follows at their end.

use super::readiness::{Arrival, Mode};
use super::setup::Setup;
use super::timing::EXERCISE_WAYS;
use super::{Actions, Controller, act};
use crate::flight::event::Action;
use crate::flight::fault::Fault;
use crate::flight::time::Time;

impl Controller {
    /// Sends the stage to and fro, and to its waiting place. Without a stage, or with a fault of
    /// it, the camera becomes ready without it.
    pub(super) fn resume(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        if !setup.camera.has_stage() || self.stage.fault().is_some() {
            self.become_ready(setup, now);
            return;
        }
        self.stage.expect_readings(now);
        self.stage.index.demand();
        self.stage.approached_mm = None;
        let place_mm = self.destination_mm(setup, now, EXERCISE_WAYS);
        if self.stage.go_to(setup, now, place_mm) {
            self.readiness.start_exercise();
        } else {
            // The reading is not finite, or the stage's end is not.
            self.fail(setup, Fault::Encoder, actions);
        }
    }

    /// Sends a stage under force to its next place, after a frame or a way.
    pub(super) fn go_back(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        let ways_left = match self.readiness.mode() {
            Mode::Fault(_) => return,
            Mode::Arming { ways_left } => ways_left,
            _ => 0,
        };
        if self.stage.is_released() {
            if self.readiness.take_disarm() {
                self.stand_by(actions);
            } else {
                self.become_ready(setup, now);
            }
            return;
        }
        let place_mm = match self.stage.approached_mm.take() {
            Some(waiting_mm) => waiting_mm,
            None => self.way_back_mm(setup, now, ways_left, actions),
        };
        if self.stage.go_to(setup, now, place_mm) {
            self.readiness.go_back();
        } else {
            // The set point is not finite.
            self.fail(setup, Fault::Drive, actions);
        }
    }

    /// Carries out what is due in a round while no frame is in flight.
    pub(super) fn look_after_readiness(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        match self.readiness.mode() {
            Mode::Standby => {}
            Mode::Armed | Mode::Degraded(_) => self.keep_ready(setup, now, actions),
            Mode::Arming { .. } | Mode::FlyBack => {
                if self.stage.has_arrived(now) {
                    self.arrive(setup, now, actions);
                }
            }
            Mode::Fault(fault) => self.recover(setup, now, fault, actions),
        }
    }

    /// Goes to standby: the stage is released.
    pub(super) fn stand_by(&mut self, actions: &mut Actions) {
        self.release(actions);
        self.readiness.set_mode(Mode::Standby);
    }

    /// Releases the stage.
    pub(super) fn release(&mut self, actions: &mut Actions) {
        if self.stage.release() {
            act(actions, Action::ReleaseStage);
        }
        // No crossing will come before somebody may have moved the stage.
        if let Some(exposures) = self.stage.unconfirmed.take_counts() {
            self.doubt(exposures, actions);
        }
    }

    /// Acts on the arrival of the stage.
    fn arrive(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        match self.readiness.arrive() {
            Arrival::StandBy => self.stand_by(actions),
            Arrival::NextWay => self.go_back(setup, now, actions),
            Arrival::Ready
                if self.stage.index.is_on_detour() || self.stage.approached_mm.is_some() =>
            {
                self.go_back(setup, now, actions);
            }
            Arrival::Ready if self.has_found_index(setup, actions) => self.become_ready(setup, now),
            Arrival::Ready => self.stand_by(actions),
        }
    }

    /// Checks if compensation is possible, and reports why it is not.
    fn keep_ready(&mut self, setup: &Setup, now: Time, actions: &mut Actions) {
        let before = self.readiness.mode();
        self.become_ready(setup, now);
        let mode = self.readiness.mode();
        if let Mode::Degraded(fault) = mode
            && mode != before
        {
            act(actions, Action::Fault(fault));
        }
    }

    fn become_ready(&mut self, setup: &Setup, now: Time) {
        let stage_fault = self.stage_fault(setup);
        let vh = &self.aircraft.vh;
        self.readiness
            .become_ready(now, stage_fault, || vh.is_known(now));
    }

    /// Leaves a fault that ends without a command.
    fn recover(&mut self, setup: &Setup, now: Time, fault: Fault, actions: &mut Actions) {
        let has_stood = || self.stage.has_stood(setup, now);
        if !self.readiness.is_over(fault, has_stood) {
            return;
        }
        if self.readiness.take_disarm() {
            self.stand_by(actions);
        } else {
            self.resume(setup, now, actions);
        }
    }

    /// Returns the end of the stage's next way, mm: across the index mark, to where the way to the
    /// waiting place takes up the play, or to the destination.
    fn way_back_mm(
        &mut self,
        setup: &Setup,
        now: Time,
        ways_left: u8,
        actions: &mut Actions,
    ) -> f32 {
        let destination_mm = self.destination_mm(setup, now, ways_left);
        let from_mm = self.stage.place_mm(now);
        let place_mm = if matches!(self.readiness.mode(), Mode::Arming { .. }) {
            destination_mm
        } else {
            self.next_place_mm(setup, from_mm, destination_mm, actions)
        };
        if ways_left > 0 || self.stage.index.is_on_detour() {
            return place_mm;
        }
        let Some(begin_mm) = setup.approach(from_mm, place_mm) else {
            return place_mm;
        };
        self.stage.approached_mm = Some(place_mm);
        begin_mm
    }

    /// Returns the stage's next position, mm: an end of the exercise or, after its last way, the
    /// waiting place.
    fn destination_mm(&self, setup: &Setup, now: Time, ways_left: u8) -> f32 {
        if ways_left == 0 {
            let vh = self.aircraft.vh.estimate(now);
            setup.waiting_place_mm(vh, self.exposure_s).unwrap_or(0.0)
        } else if ways_left.is_multiple_of(2) {
            setup.exercise_ends().low_mm
        } else {
            setup.exercise_ends().high_mm
        }
    }
}
