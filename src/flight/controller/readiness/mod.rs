//! The machine of readiness: it decides if a trigger is obeyed, and with or without compensation.

mod rounds;

pub(super) use self::rounds::Round;
use self::rounds::Rounds;
use super::stage::Obedience;
use super::state::State;
use super::timing::{CLOCK_JUMP_S, EXERCISE_WAYS, LATE_EVENT_S, PAUSE_S};
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
use crate::flight::time::Time;

/// [`LATE_EVENT_S`] and [`CLOCK_JUMP_S`], µs: every event is compared with them.
const LATE_EVENT_US: u64 = whole_us(LATE_EVENT_S);
const CLOCK_JUMP_US: u64 = whole_us(CLOCK_JUMP_S);
/// [`PAUSE_S`], µs.
const PAUSE_US: u64 = whole_us(PAUSE_S);

/// The machine of readiness.
#[derive(Debug, Clone)]
pub(super) struct Readiness {
    mode: Mode,
    is_supply_good: bool,
    /// A disarm waits until the exposure or the stage's way has ended.
    is_disarming: bool,
    /// The flight began before a reset: the fault of the start ends by itself.
    flies_on: bool,
    last_event: Option<Time>,
    /// Longest time from one event to the next without a jump of the clock, µs.
    longest_us: u64,
    rounds: Rounds,
    late_ticks: u32,
    lost_events: u32,
}

/// State of readiness, except for a frame in flight, which begins in [`Self::Armed`] or
/// [`Self::Degraded`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    /// Triggers are refused; the stage is left alone.
    Standby,
    /// The stage goes to and fro: `ways_left` ways are left, and then the one to the waiting place.
    Arming { ways_left: u8 },
    /// The stage returns after a frame.
    FlyBack,
    /// A trigger is obeyed.
    Armed,
    /// A trigger is obeyed, without compensation because of a fault.
    Degraded(Fault),
    /// Something went wrong; the stage is released.
    Fault(Fault),
}

/// Next step after the stage has arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrival {
    /// Go to standby.
    StandBy,
    /// Make another way of the exercise.
    NextWay,
    /// Become ready.
    Ready,
}

/// Consequence of a command to disarm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Disarming {
    /// Nothing, or nothing yet.
    Later,
    /// Go to standby.
    Now,
    /// Call off the frame in flight.
    CallOff,
}

impl Readiness {
    /// Returns the machine in standby, or with the fault of a start after the watchdog.
    pub(super) const fn new(mode: Mode) -> Self {
        Self {
            mode,
            is_supply_good: true,
            is_disarming: false,
            flies_on: false,
            last_event: None,
            longest_us: CLOCK_JUMP_US,
            rounds: Rounds::new(),
            late_ticks: 0,
            lost_events: 0,
        }
    }

    /// Notes that the flight goes on after a reset.
    pub(super) const fn fly_on(&mut self) {
        self.flies_on = true;
    }

    /// Returns `true` if the camera is armed, or will be by itself.
    #[cfg(feature = "link")]
    pub(super) const fn is_flying(&self) -> bool {
        match self.mode {
            _ if self.is_disarming => false,
            Mode::Standby => false,
            Mode::Fault(fault) => !self.waits_for_operator(fault),
            _ => true,
        }
    }

    /// Returns `true` for a fault that the operator has to clear.
    const fn waits_for_operator(&self, fault: Fault) -> bool {
        match fault {
            Fault::Clock | Fault::ShutterLong => true,
            Fault::Watchdog => !self.flies_on,
            _ => false,
        }
    }

    /// The mode, frames in flight left out.
    pub(super) const fn mode(&self) -> Mode {
        self.mode
    }

    pub(super) const fn set_mode(&mut self, mode: Mode) {
        self.mode = mode;
    }

    /// Returns the state that is reported, given that of a frame in flight.
    pub(super) const fn state(&self, in_flight: Option<State>) -> State {
        match (self.mode, in_flight) {
            (Mode::Fault(fault), _) => State::Fault(fault),
            (_, Some(state)) => state,
            (Mode::Standby, None) => State::Standby,
            (Mode::Arming { .. } | Mode::FlyBack, None) => State::FlyBack,
            (Mode::Armed, None) => State::Armed,
            (Mode::Degraded(fault), None) => State::Degraded(fault),
        }
    }

    /// Decides how a trigger is obeyed: `None` is with compensation, a fault is without it.
    ///
    /// # Errors
    /// The reason why the trigger is refused.
    pub(super) const fn admit(&self, is_in_flight: bool) -> Result<Option<Fault>, Reason> {
        match self.mode {
            Mode::Fault(fault) => Err(Reason::Fault(fault)),
            Mode::Standby | Mode::Arming { .. } => Err(Reason::NotArmed),
            Mode::FlyBack => Err(Reason::Overlap),
            Mode::Armed | Mode::Degraded(_) if is_in_flight => Err(Reason::Overlap),
            Mode::Armed => Ok(None),
            Mode::Degraded(fault) => Ok(Some(fault)),
        }
    }

    /// Notes that the board has made no rounds for a while, of up to [`PAUSE_S`].
    pub(super) const fn note_pause(&mut self) {
        self.longest_us = PAUSE_US;
    }

    /// Takes the time of an event. Returns `true` if the clock has jumped: events come in order of
    /// time, or nearly so, and at least one with every round, but for a pause.
    pub(super) fn has_jumped(&mut self, time: Time) -> bool {
        let Some(last) = self.last_event else {
            self.last_event = Some(time);
            return false;
        };
        if time >= last {
            if time.us_since(last) > self.longest_us {
                return true;
            }
            self.last_event = Some(time);
            return false;
        }
        last.us_since(time) > LATE_EVENT_US
    }

    /// Restarts the times after a jump of the clock to a time.
    pub(super) const fn restart_clock(&mut self, time: Time) {
        self.last_event = Some(time);
        self.rounds.restart();
    }

    /// Time of the last event; `None` before the first.
    pub(super) const fn last_event(&self) -> Option<Time> {
        self.last_event
    }

    /// Returns `true` before the first round.
    pub(super) const fn is_before_first_round(&self) -> bool {
        self.rounds.last().is_none()
    }

    /// Takes a round. Late rounds are counted; in standby, where a request may last longer than a
    /// round, they have no other consequence.
    pub(super) fn come_round(&mut self, now: Time) -> Round {
        self.longest_us = CLOCK_JUMP_US;
        let round = self.rounds.look(now, self.mode != Mode::Standby);
        if let Round::Idle | Round::Late | Round::Overload = round {
            self.late_ticks = self.late_ticks.saturating_add(1);
        }
        round
    }

    /// Counts events that were lost.
    pub(super) const fn lose(&mut self, events: u32) {
        self.lost_events = self.lost_events.saturating_add(events);
    }

    /// Takes the command to arm. Returns `true` if arming begins, which it does in standby alone;
    /// in any other state the command takes a disarm back.
    ///
    /// # Errors
    /// The fault that prevents arming.
    pub(super) const fn arm(&mut self) -> Result<bool, Fault> {
        match self.mode {
            Mode::Standby if !self.is_supply_good => Err(Fault::BrownOut),
            Mode::Standby => Ok(true),
            _ => {
                self.is_disarming = false;
                Ok(false)
            }
        }
    }

    /// Takes the command to disarm; `state` is the reported one.
    pub(super) const fn disarm(&mut self, state: State) -> Disarming {
        match state {
            State::Standby => Disarming::Later,
            State::Armed | State::Degraded(_) => Disarming::Now,
            State::RunUp | State::Tracking => {
                self.is_disarming = true;
                Disarming::CallOff
            }
            State::Exposing | State::FlyBack | State::Fault(_) => {
                self.is_disarming = true;
                Disarming::Later
            }
        }
    }

    /// Returns `true` if a disarm has waited until now, and forgets it.
    pub(super) const fn take_disarm(&mut self) -> bool {
        core::mem::replace(&mut self.is_disarming, false)
    }

    /// Acknowledges the fault. Returns `true` if it ends with that.
    pub(super) const fn clear_fault(&mut self) -> bool {
        let is_over = matches!(
            self.mode,
            Mode::Fault(_) | Mode::Degraded(_) | Mode::Standby
        );
        if is_over {
            self.rounds.forget_overload();
            self.is_disarming = false;
        }
        is_over
    }

    /// Notes that the supply is good, or too low to move the stage.
    pub(super) const fn set_supply(&mut self, is_good: bool) {
        self.is_supply_good = is_good;
    }

    /// Returns `true` unless the supply is too low to move the stage.
    pub(super) const fn is_supply_good(&self) -> bool {
        self.is_supply_good
    }

    /// Notes that the stage begins its exercise.
    pub(super) const fn start_exercise(&mut self) {
        self.mode = Mode::Arming {
            ways_left: EXERCISE_WAYS,
        };
    }

    /// Notes that the stage begins a way back: of the exercise, or after a frame.
    pub(super) const fn go_back(&mut self) {
        if !matches!(self.mode, Mode::Arming { .. }) {
            self.mode = Mode::FlyBack;
        }
    }

    /// Notes that the stage has arrived.
    pub(super) const fn arrive(&mut self) -> Arrival {
        if self.take_disarm() {
            return Arrival::StandBy;
        }
        match self.mode {
            Mode::Arming { ways_left } if ways_left > 0 => {
                self.mode = Mode::Arming {
                    ways_left: ways_left.saturating_sub(1),
                };
                Arrival::NextWay
            }
            _ => Arrival::Ready,
        }
    }

    /// Becomes ready for a trigger, with compensation or, for want of stage, time or V/H, without.
    pub(super) fn become_ready(
        &mut self,
        now: Time,
        stage_fault: Option<Fault>,
        has_vh: impl FnOnce() -> bool,
    ) {
        let is_overloaded = self.rounds.is_overloaded(now);
        let why_not = if stage_fault.is_some() {
            stage_fault
        } else if is_overloaded {
            Some(Fault::Overload)
        } else if has_vh() {
            None
        } else {
            Some(Fault::VhLost)
        };
        self.mode = why_not.map_or(Mode::Armed, Mode::Degraded);
    }

    /// Takes a fault, which ends every mode except standby and a fault. Returns `true` if it has
    /// ended one.
    pub(super) const fn fail(&mut self, fault: Fault) -> bool {
        if let Mode::Standby | Mode::Fault(_) = self.mode {
            return false;
        }
        self.mode = Mode::Fault(fault);
        true
    }

    /// Returns `true` if a fault has ended without a command; for most faults the stage must have
    /// stood still.
    pub(super) fn is_over(&self, fault: Fault, has_stood: impl FnOnce() -> bool) -> bool {
        match fault {
            _ if self.waits_for_operator(fault) => false,
            Fault::BrownOut => self.is_supply_good,
            Fault::Watchdog => self.is_supply_good && has_stood(),
            _ => has_stood(),
        }
    }

    /// Degree to which the stage is expected to follow.
    pub(super) const fn obedience(&self) -> Obedience {
        match self.mode {
            Mode::Standby | Mode::Fault(_) => Obedience::None,
            Mode::Arming { ways_left } if ways_left > 0 => Obedience::Unlearned,
            _ => Obedience::Full,
        }
    }

    pub(super) const fn late_ticks(&self) -> u32 {
        self.late_ticks
    }

    pub(super) const fn lost_events(&self) -> u32 {
        self.lost_events
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a second at most"
)]
const fn whole_us(seconds: f32) -> u64 {
    (seconds * 1e6 + 0.5) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_has_jumped_by_more_than_a_second_or_back_by_more_than_an_event_may_be_late() {
        assert_eq!((LATE_EVENT_US, CLOCK_JUMP_US), (10_000, 1_000_000));
        let last = Time::from_us(5_000_000);
        for us in (0..20_000).chain(999_000..1_001_000) {
            for time in [5_000_000 - us, 5_000_000 + us].map(Time::from_us) {
                let mut readiness = Readiness::new(Mode::Standby);
                assert!(!readiness.has_jumped(last), "the first");
                let later_s = time.seconds_since(last);
                let expected = !(-LATE_EVENT_S..=CLOCK_JUMP_S).contains(&later_s);
                assert_eq!(readiness.has_jumped(time), expected, "{later_s} s");
                let latest = if expected { last } else { last.max(time) };
                assert_eq!(readiness.last_event, Some(latest));
            }
        }
    }

    #[test]
    fn whole_microseconds_are_the_nearest() {
        let seconds = [0.0, 0.25e-6, 0.75e-6, 0.0105, 2.5];
        let us = seconds.map(|seconds| whole_us(core::hint::black_box(seconds)));
        assert_eq!(us, [0, 0, 1, 10_500, 2_500_000]);
    }

    #[cfg(feature = "link")]
    #[test]
    fn camera_that_waits_to_be_disarmed_flies_no_more() {
        let mut readiness = Readiness::new(Mode::Armed);
        assert!(readiness.is_flying());
        assert_eq!(readiness.disarm(State::Exposing), Disarming::Later);
        assert!(!readiness.is_flying());
        // The command to arm takes it back.
        assert_eq!(readiness.arm(), Ok(false));
        assert!(readiness.is_flying());
    }

    #[test]
    fn fault_of_the_watchdog_lasts_while_the_supply_is_low() {
        let mut readiness = Readiness::new(Mode::Fault(Fault::Watchdog));
        assert!(!readiness.is_over(Fault::Watchdog, || true), "a new flight");
        readiness.fly_on();
        readiness.set_supply(false);
        assert!(!readiness.is_over(Fault::Watchdog, || true));
        readiness.set_supply(true);
        assert!(!readiness.is_over(Fault::Watchdog, || false));
        assert!(readiness.is_over(Fault::Watchdog, || true));
    }
}
