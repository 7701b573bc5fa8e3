//! Seconds by which the receiver's times name the pulses.

use super::{CONSISTENT_TIMES, Pulse, UtcClock, UtcFinding};
use crate::flight::time::Time;

/// Number of seconds by which the receiver contradicts the count of pulses, number of pulses in a
/// row at which it does, and the last of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Doubt {
    pub(super) difference_s: i64,
    times: u8,
    pulse: Time,
}

impl UtcClock {
    /// Compares the second that a time gives to the last pulse with the count, or begins the count.
    pub(super) fn name(&mut self, pulse: Pulse, second: u64) -> Option<UtcFinding> {
        let named = match pulse.second {
            Some(counted) if counted == second => {
                pulse.named.saturating_add(u8::from(!pulse.is_named))
            }
            Some(counted) if pulse.is_counted_on => {
                return Some(self.contradict(pulse, counted, second));
            }
            // The count is not trusted yet and begins anew.
            _ => 1,
        };
        self.doubt = None;
        self.pulse = Some(Pulse {
            second: Some(second),
            named,
            is_named: true,
            is_counted_on: pulse.is_counted_on || named >= CONSISTENT_TIMES,
            ..pulse
        });
        None
    }

    fn contradict(&mut self, pulse: Pulse, counted: u64, second: u64) -> UtcFinding {
        let difference_s = signed(second).saturating_sub(signed(counted));
        let times = match self.doubt {
            Some(doubt) if doubt.difference_s == difference_s => {
                // Several times of one pulse count once.
                let more = u8::from(doubt.pulse != pulse.time);
                doubt.times.saturating_add(more)
            }
            _ => 1,
        };
        if times >= CONSISTENT_TIMES {
            self.doubt = None;
            self.stepped_s = self.stepped_s.saturating_add(difference_s);
            self.pulse = Some(Pulse {
                second: Some(second),
                named: CONSISTENT_TIMES,
                ..pulse
            });
            return UtcFinding::Stepped(difference_s);
        }
        if !pulse.is_trusted() {
            // The names of a count that goes on agree in a row, or it is not trusted.
            self.pulse = Some(Pulse { named: 0, ..pulse });
        }
        self.doubt = Some(Doubt {
            difference_s,
            times,
            pulse: pulse.time,
        });
        UtcFinding::WrongSecond(difference_s)
    }
}

/// Converts seconds to a number that may be subtracted; no more occur in the life of the sun.
fn signed(seconds: u64) -> i64 {
    i64::try_from(seconds).unwrap_or(i64::MAX)
}
