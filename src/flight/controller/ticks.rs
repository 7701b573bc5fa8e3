//! The control loop comes round.

use super::state::State;
use super::timing::{
    CLOCK_JUMP_S, LATE_EVENT_S, LATE_TICK_S, LEAD_S, OVERLOAD_ROUNDS, OVERLOAD_WINDOW_S,
    READING_WITHIN_S, SHUTTER_GIVEN_UP_S, SHUTTER_MISSING_S, STANDING_S, TICK_S,
};
use super::{Actions, Controller, act};
use crate::flight::event::Action;
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
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
        // What was measured so far has nothing to do with the times to come.
        self.last_event = Some(time);
        self.last_tick = None;
        if let Some(opened) = self.frame.and_then(|frame| frame.opened) {
            let exposure_s = self.frame.map_or(0.0, |frame| frame.exposure.exposure_s);
            self.note(Fault::Clock);
            self.give_up_exposure(time, opened.plus_s(exposure_s), actions);
        }
        self.track.clear();
        self.following.clear();
        self.standing_since = None;
        self.fail(time, Fault::Clock, actions);
    }

    pub(super) fn tick(&mut self, now: Time, actions: &mut Actions) {
        self.check_rounds(now, actions);
        self.look_after_frame(now, actions);
        match self.state {
            State::Armed if self.vh.estimate(now).is_none() => {
                self.degraded = Some(Fault::VhLost);
                self.state = State::Degraded(Fault::VhLost);
                act(actions, Action::Fault(Fault::VhLost));
            }
            State::Degraded(Fault::VhLost) if self.vh.estimate(now).is_some() => {
                self.degraded = None;
                self.state = State::Armed;
            }
            State::Degraded(Fault::Overload)
                if now.seconds_since(self.late_since) > OVERLOAD_WINDOW_S =>
            {
                self.degraded = None;
                self.state = State::Armed;
            }
            State::FlyBack if self.motion.is_over(now) => self.arrive(now, actions),
            State::Fault(fault) if self.frame.is_none() => self.recover(now, fault, actions),
            _ => {}
        }
        if let Some(setpoint) = self.motion.setpoint(now) {
            act(actions, Action::MoveStage(setpoint));
        }
    }

    /// Late rounds are counted, and lead to flying without compensation where there are too many.
    fn check_rounds(&mut self, now: Time, actions: &mut Actions) {
        let Some(last) = self.last_tick.replace(now) else {
            return;
        };
        let round_s = now.seconds_since(last);
        if round_s <= LATE_TICK_S {
            return;
        }
        self.counts.late_ticks = self.counts.late_ticks.saturating_add(1);
        if now.seconds_since(self.late_since) > OVERLOAD_WINDOW_S {
            self.late_lately = 0;
        }
        self.late_since = now;
        self.late_lately = self.late_lately.saturating_add(1);
        self.note(Fault::Overload);
        if self.late_lately >= OVERLOAD_ROUNDS {
            self.overload(now, actions);
        }
    }

    fn overload(&mut self, now: Time, actions: &mut Actions) {
        match self.state {
            State::Armed => self.state = State::Degraded(Fault::Overload),
            State::RunUp | State::Tracking => {
                self.call_off(now, Reason::Fault(Fault::Overload), actions);
            }
            State::Exposing | State::FlyBack => {}
            State::Standby | State::Fault(_) | State::Degraded(_) => return,
        }
        if self.degraded.replace(Fault::Overload) != Some(Fault::Overload) {
            act(actions, Action::Fault(Fault::Overload));
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
                let command = frame.first_light.plus_s(-self.settings.shutter_latency_s);
                if late_s > self.settings.shutter_tolerance_s + SHUTTER_MISSING_S {
                    act(actions, Action::Fault(Fault::ShutterMissing));
                    self.note(Fault::ShutterMissing);
                    self.call_off(now, Reason::ShutterMissing, actions);
                } else if now < command && now.plus_s(TICK_S) >= command && !self.is_at_speed() {
                    // The last moment in which the command can be taken back.
                    act(actions, Action::CloseShutter);
                    self.state = State::RunUp;
                    self.change_frame(|frame| frame.is_commanded = false);
                }
            }
            (Some(opened), None) => {
                let open_s = now.seconds_since(opened);
                let over_s = open_s - frame.exposure.exposure_s - self.settings.shutter_tolerance_s;
                if over_s > SHUTTER_GIVEN_UP_S {
                    self.give_up_exposure(now, now, actions);
                    self.fail(now, Fault::ShutterLong, actions);
                } else if over_s > 0.0 && !frame.faults.contains(Fault::ShutterLong) {
                    self.note(Fault::ShutterLong);
                    act(actions, Action::Fault(Fault::ShutterLong));
                    act(actions, Action::CloseShutter);
                }
            }
            (Some(_), Some(closed)) => {
                let is_read = self.track.last().is_some_and(|last| last.time >= closed);
                if is_read
                    || !self.camera.has_stage()
                    || now.seconds_since(closed) > READING_WITHIN_S
                {
                    self.record_exposure(now, actions);
                }
            }
        }
    }

    /// Tells the shutter to open when it is time, or gives up.
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
            self.call_off(now, Reason::NotAtSpeed, actions);
            return;
        }
        // A command that was taken back is repeated where the stage has come to its speed meanwhile.
        if now >= planned && !self.is_at_speed() {
            return;
        }
        let at = planned.max(now);
        self.change_frame(|frame| {
            frame.is_commanded = true;
            frame.first_light = at.plus_s(latency_s);
        });
        self.state = State::Tracking;
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
    fn is_at_speed(&self) -> bool {
        let Some(frame) = &self.frame else {
            return false;
        };
        if !self.camera.has_stage() || self.is_place_lost {
            return true;
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
        } else if self.exercise > 0 {
            self.exercise = self.exercise.saturating_sub(1);
            self.go_back(now, actions);
        } else {
            self.state = self.ready();
        }
    }

    /// Ready for a trigger, with or without compensation.
    pub(super) fn ready(&self) -> State {
        self.degraded.map_or(State::Armed, State::Degraded)
    }

    /// The way out of a fault that needs nobody.
    fn recover(&mut self, now: Time, fault: Fault, actions: &mut Actions) {
        match fault {
            Fault::BrownOut if self.is_supply_good => self.resume(now, actions),
            Fault::Stall
            | Fault::Runaway
            | Fault::WrongDirection
            | Fault::LimitSwitch
            | Fault::Encoder
            | Fault::Drive
                if self.has_stood(now) =>
            {
                self.degraded = Some(fault);
                if core::mem::take(&mut self.is_disarming) {
                    self.stand_by(actions);
                } else {
                    self.state = State::Degraded(fault);
                }
            }
            _ => {}
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
