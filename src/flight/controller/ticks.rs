//! The control loop comes round.

use super::frame::FrameInFlight;
use super::rounds::Round;
use super::state::State;
use super::timing::{
    CLOCK_JUMP_S, LATE_EVENT_S, LATE_TICK_S, LEAD_S, READING_WITHIN_S, READINGS_CEASE_S,
    SHUTTER_GIVEN_UP_S, SHUTTER_MISSING_S, STANDING_S,
};
use super::{Actions, Controller, act};
use crate::flight::event::Action;
use crate::flight::fault::Fault;
use crate::flight::frame_record::{Flag, Reason};
use crate::flight::time::Time;

impl Controller {
    /// Events come in order of time, or nearly so, and one at least with every round.
    pub(super) fn check_clock(&mut self, time: Time, actions: &mut Actions) {
        let Some(last) = self.last_event else {
            self.last_event = Some(time);
            return;
        };
        let later_s = time.seconds_since(last);
        if (-LATE_EVENT_S..=CLOCK_JUMP_S).contains(&later_s) {
            self.last_event = Some(last.max(time));
            return;
        }
        self.jump_of_the_clock(time, actions);
    }

    /// What was measured so far has nothing to do with the times to come.
    fn jump_of_the_clock(&mut self, time: Time, actions: &mut Actions) {
        self.last_event = Some(time);
        self.rounds.restart();
        self.last_reading = time;
        self.note(Fault::Clock);
        if let Some(FrameInFlight {
            opened: Some(opened),
            exposure,
            ..
        }) = self.frame
        {
            self.change_frame(|frame| {
                frame.is_end_assumed |= frame.closed.is_none();
                frame.flags.insert(Flag::PlannedMotion);
                frame.closed = frame.closed.or(Some(opened.plus_s(exposure.exposure_s)));
            });
            self.record_exposure(time, actions);
        }
        self.track.clear();
        self.following.clear();
        self.standing_since = None;
        self.stop(Fault::Clock, actions);
    }

    pub(super) fn tick(&mut self, now: Time, actions: &mut Actions) {
        if self.rounds.last().is_none() && self.state == State::Fault(Fault::Watchdog) {
            // Nobody knows what the shutter was told before.
            act(actions, Action::CloseShutter);
        }
        self.check_round(now, actions);
        self.start(now);
        if self.motion.is_some() && now.seconds_since(self.last_reading) > READINGS_CEASE_S {
            self.fail(Fault::Encoder, actions);
        }
        self.look_after_frame(now, actions);
        match self.state {
            State::Armed | State::Degraded(_) => self.keep_ready(now, actions),
            State::FlyBack
                if self
                    .motion
                    .as_ref()
                    .is_none_or(|motion| motion.is_over(now)) =>
            {
                self.arrive(now, actions);
            }
            State::Fault(fault) if self.frame.is_none() => self.recover(now, fault, actions),
            _ => {}
        }
        if let Some(motion) = &self.motion {
            act(actions, Action::MoveStage(motion.setpoint(now)));
        }
    }

    /// Late rounds are counted, and lead to flying without compensation where there are too many; not those of standby,
    /// where a request may last longer than a round.
    fn check_round(&mut self, now: Time, actions: &mut Actions) {
        let round = self.rounds.look(now, self.state != State::Standby);
        match round {
            Round::Punctual => {}
            Round::Backwards => self.jump_of_the_clock(now, actions),
            Round::Idle | Round::Late | Round::Overload => {
                self.counts.late_ticks = self.counts.late_ticks.saturating_add(1);
            }
        }
        if let Round::Late | Round::Overload = round {
            self.note(Fault::Overload);
        }
        if round == Round::Overload {
            act(actions, Action::Fault(Fault::Overload));
            if let State::RunUp | State::Tracking = self.state {
                self.call_off(now, Reason::Fault(Fault::Overload), actions);
            }
        }
    }

    /// What the time asks of the frame in flight.
    fn look_after_frame(&mut self, now: Time, actions: &mut Actions) {
        let Some(frame) = self.frame else {
            return;
        };
        match (frame.opened, frame.closed) {
            (None, _) if !frame.is_commanded => self.command_shutter(now, actions),
            (None, _) => {
                let late_s = now.seconds_since(frame.first_light);
                if late_s > self.settings.shutter_tolerance_s + SHUTTER_MISSING_S {
                    act(actions, Action::Fault(Fault::ShutterMissing));
                    self.note(Fault::ShutterMissing);
                    self.call_off(now, Reason::ShutterMissing, actions);
                }
            }
            (Some(opened), None) => self.look_for_last_light(now, opened, actions),
            (Some(_), Some(closed)) => {
                let is_read = self.track.last().is_some_and(|last| last.time >= closed);
                if is_read
                    || !self.camera.has_stage()
                    || now.seconds_since(closed) > READING_WITHIN_S
                {
                    if frame.measured.is_some() {
                        self.record_exposure(now, actions);
                    } else {
                        self.measure_exposure();
                    }
                }
            }
        }
    }

    /// A shutter that is open for too long is told to close, and given up where that does not help.
    fn look_for_last_light(&mut self, now: Time, opened: Time, actions: &mut Actions) {
        let Some(frame) = self.frame else {
            return;
        };
        let planned = opened.plus_s(frame.exposure.exposure_s);
        match frame.told_to_close {
            None if now.seconds_since(planned) > self.settings.shutter_tolerance_s => {
                self.note(Fault::ShutterLong);
                self.change_frame(|frame| frame.told_to_close = Some(now));
                act(actions, Action::Fault(Fault::ShutterLong));
                act(actions, Action::CloseShutter);
            }
            Some(told) if now.seconds_since(told) > SHUTTER_GIVEN_UP_S => {
                self.change_frame(|frame| {
                    frame.is_end_assumed = true;
                    frame.closed = Some(planned);
                });
                self.record_exposure(now, actions);
                self.stop(Fault::ShutterLong, actions);
            }
            _ => {}
        }
    }

    /// Tells the shutter to open in the last round before it is time, if the stage is at speed by then; a little later
    /// if it is by then; or gives up.
    fn command_shutter(&mut self, now: Time, actions: &mut Actions) {
        let Some(frame) = self.frame else {
            return;
        };
        let latency_s = self.settings.shutter_latency_s;
        let planned = frame.first_light.plus_s(-latency_s);
        if now.plus_s(LEAD_S) < planned {
            return;
        }
        if now.seconds_since(planned) > self.settings.shutter_tolerance_s {
            let reason = if frame.faults.contains(Fault::Overload) {
                Reason::Fault(Fault::Overload)
            } else {
                Reason::NotAtSpeed
            };
            self.call_off(now, reason, actions);
            return;
        }
        if !self.is_at_speed(now) {
            return;
        }
        let at = planned.max(now);
        self.change_frame(|frame| {
            frame.is_commanded = true;
            frame.first_light = at.plus_s(latency_s);
        });
        self.state = State::Tracking;
        if !self.camera.has_stage() {
            let speed_mm_s = frame.planned_travel_mm / frame.exposure.exposure_s;
            act(actions, Action::ClockRows { at, speed_mm_s });
        }
        act(
            actions,
            Action::OpenShutter {
                at,
                exposure_s: frame.exposure.exposure_s,
            },
        );
    }

    /// Whether the speed is right to within 1 % or the smear budget: the following error must not change by more
    /// while the shutter is open.
    fn is_at_speed(&self, now: Time) -> bool {
        let Some(frame) = &self.frame else {
            return false;
        };
        if !self.camera.has_stage() || self.is_place_lost {
            return true;
        }
        if now.seconds_since(self.last_reading) > LATE_TICK_S {
            return false;
        }
        let Some(error_mm_s) = self.following.per_s() else {
            return false;
        };
        let exposure_s = frame.exposure.exposure_s;
        let budget_mm =
            self.settings.smear_budget_px * self.camera.calibration().sensor().pixel_mm();
        let allowed_mm =
            (0.01 * self.settings.speed_tolerance_percent * libm::fabsf(frame.planned_travel_mm))
                .max(budget_mm);
        libm::fabsf(error_mm_s) * exposure_s <= allowed_mm
    }

    /// The stage is back.
    fn arrive(&mut self, now: Time, actions: &mut Actions) {
        if core::mem::take(&mut self.is_disarming) {
            self.stand_by(actions);
        } else if let Some(ways) = self.arming.filter(|ways| *ways > 0) {
            self.arming = Some(ways.saturating_sub(1));
            self.go_back(now, actions);
        } else {
            self.arming = None;
            self.state = self.ready(now);
        }
    }

    /// Ready for a trigger, with compensation or, for want of stage, time or V/H, without.
    pub(super) fn ready(&mut self, now: Time) -> State {
        let is_overloaded = self.rounds.is_overloaded(now);
        let why_not = if self.stage_fault.is_some() {
            self.stage_fault
        } else if is_overloaded {
            Some(Fault::Overload)
        } else if self.vh.estimate(now).is_none() {
            Some(Fault::VhLost)
        } else {
            None
        };
        why_not.map_or(State::Armed, State::Degraded)
    }

    /// Looks whether compensation is possible, or possible again.
    fn keep_ready(&mut self, now: Time, actions: &mut Actions) {
        let ready = self.ready(now);
        if let State::Degraded(fault) = ready
            && ready != self.state
        {
            act(actions, Action::Fault(fault));
        }
        self.state = ready;
    }

    /// The way out of a fault that needs nobody.
    fn recover(&mut self, now: Time, fault: Fault, actions: &mut Actions) {
        let is_over = match fault {
            Fault::BrownOut => self.is_supply_good,
            // Somebody must look at these.
            Fault::Clock | Fault::Watchdog | Fault::ShutterLong => false,
            _ => self.has_stood(now),
        };
        if !is_over {
            return;
        }
        if core::mem::take(&mut self.is_disarming) {
            self.stand_by(actions);
        } else {
            self.resume(now, actions);
        }
    }

    /// Whether the stage has not moved for [`STANDING_S`], as far as can be seen.
    fn has_stood(&mut self, now: Time) -> bool {
        let offset_mm = self.track.last().map_or(0.0, |reading| reading.offset_mm);
        let tolerance_mm = self.settings.stage_tolerance().following_mm;
        match self.standing_since {
            Some((since, place_mm)) if libm::fabsf(offset_mm - place_mm) <= tolerance_mm => {
                now.seconds_since(since) > STANDING_S
            }
            _ => {
                self.standing_since = Some((now, offset_mm));
                false
            }
        }
    }
}
