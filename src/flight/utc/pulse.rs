//! Time pulses with their seconds, and contradictions of them.

use crate::flight::time::Time;

/// Number of pulses in a row that must be named alike before there is absolute time, and before the
/// names replace the count of pulses.
pub const CONSISTENT_TIMES: u8 = 3;

/// The last pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pulse {
    pub(super) time: Time,
    /// Second that begins with it, s since 1970.
    pub(super) second: Option<u64>,
    /// Number of pulses in a row that have been named so.
    named: u8,
    /// The pulse itself is among them: several times of one pulse count once.
    is_named: bool,
    /// The count goes on from pulses that were trusted, even if it is not trusted yet itself: only
    /// as many names as make a trusted one replace it.
    pub(super) is_counted_on: bool,
}

impl Pulse {
    /// Returns a pulse that nothing has named, with its second if the count goes on.
    pub(super) const fn new(time: Time, second: Option<u64>) -> Self {
        Self {
            time,
            second,
            named: 0,
            is_named: false,
            is_counted_on: second.is_some(),
        }
    }

    /// Returns the pulse a number of seconds later, which continues the count.
    pub(super) fn later(self, time: Time, seconds: u32) -> Self {
        Self {
            time,
            second: self
                .second
                .map(|second| second.saturating_add(u64::from(seconds))),
            is_named: false,
            ..self
        }
    }

    /// Returns the pulse after a time has named it; the names so far count if they agree.
    pub(super) fn named(self, second: u64) -> Self {
        let named = if self.second == Some(second) {
            self.named.saturating_add(u8::from(!self.is_named))
        } else {
            1
        };
        Self {
            second: Some(second),
            named,
            is_named: true,
            is_counted_on: self.is_counted_on || named >= CONSISTENT_TIMES,
            ..self
        }
    }

    /// Returns the pulse after a time has contradicted it: names that agree in a row make a count
    /// trusted.
    pub(super) const fn contradicted(self) -> Self {
        if self.is_trusted() {
            self
        } else {
            Self { named: 0, ..self }
        }
    }

    /// Returns the pulse with the second that has replaced the count.
    pub(super) const fn replaced(self, second: u64) -> Self {
        Self {
            second: Some(second),
            named: CONSISTENT_TIMES,
            ..self
        }
    }

    /// Returns `true` if the second of the pulse is trusted.
    pub(super) const fn is_trusted(&self) -> bool {
        self.named >= CONSISTENT_TIMES
    }
}

/// Number of seconds by which the receiver contradicts the count of pulses, number of pulses in a
/// row at which it does, and the last of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Doubt {
    pub(super) difference_s: i64,
    pub(super) times: u8,
    pulse: Time,
}

impl Doubt {
    /// Returns the contradiction after another time of a pulse; several times of one pulse count
    /// once.
    pub(super) fn after(before: Option<Self>, difference_s: i64, pulse: Time) -> Self {
        let times = match before {
            Some(doubt) if doubt.difference_s == difference_s => {
                doubt.times.saturating_add(u8::from(doubt.pulse != pulse))
            }
            _ => 1,
        };
        Self {
            difference_s,
            times,
            pulse,
        }
    }
}
