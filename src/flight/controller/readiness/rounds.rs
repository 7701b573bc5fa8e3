//! Timing of the control loop's rounds.

use crate::flight::controller::timing::{LATE_TICK_S, OVERLOAD_ROUNDS, OVERLOAD_WINDOW_S};
use crate::flight::time::Time;

/// The rounds of the control loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounds {
    last: Option<Time>,
    late_lately: u8,
    /// The first and the last of the late rounds.
    late_first: Time,
    late_last: Time,
    is_overloaded: bool,
}

/// Finding of a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Round {
    Punctual,
    /// Later than it should be.
    Late,
    /// As late, but nothing depends on it.
    Idle,
    /// Late, and for the first time too many others were late recently.
    Overload,
    /// Earlier than the round before.
    Backwards,
}

impl Rounds {
    /// Returns the state before the first round.
    pub(super) const fn new() -> Self {
        Self {
            last: None,
            late_lately: 0,
            late_first: Time::START,
            late_last: Time::START,
            is_overloaded: false,
        }
    }

    /// Judges a round; `is_needed` is `true` if anything depends on its time.
    pub(super) fn look(&mut self, now: Time, is_needed: bool) -> Round {
        let Some(last) = self.last.replace(now) else {
            return Round::Punctual;
        };
        if now < last {
            return Round::Backwards;
        }
        if now.seconds_since(last) <= LATE_TICK_S {
            return Round::Punctual;
        }
        if !is_needed {
            return Round::Idle;
        }
        if now.seconds_since(self.late_first) > OVERLOAD_WINDOW_S {
            self.late_lately = 0;
            self.late_first = now;
        }
        self.late_last = now;
        self.late_lately = self.late_lately.saturating_add(1);
        if self.late_lately >= OVERLOAD_ROUNDS && !self.is_overloaded {
            self.is_overloaded = true;
            Round::Overload
        } else {
            Round::Late
        }
    }

    /// Returns `true` after too many late rounds, until rounds have been punctual for a while.
    pub(super) fn is_overloaded(&mut self, now: Time) -> bool {
        if self.is_overloaded && now.seconds_since(self.late_last) > OVERLOAD_WINDOW_S {
            self.forget_overload();
        }
        self.is_overloaded
    }

    /// Ends the overload, which the operator has acknowledged.
    pub(super) const fn forget_overload(&mut self) {
        self.is_overloaded = false;
        self.late_lately = 0;
    }

    /// Restarts after a jump of the clock: the next round is the first.
    pub(super) const fn restart(&mut self) {
        self.last = None;
    }

    /// Time of the last round.
    pub(super) const fn last(&self) -> Option<Time> {
        self.last
    }
}
