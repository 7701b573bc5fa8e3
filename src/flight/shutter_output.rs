//! Output wire that opens the shutter.

use super::time::Time;

/// Levels and times of the wire, for the interrupt of a compare output.
///
/// High opens the shutter, low closes it. The user calls [`Self::look`] after every change and at
/// every compare, sets the wire's level and the time of the next compare, and calls it again if
/// that time has passed meanwhile. A timer may also set the level by itself when it compares equal:
/// then the interrupt, however late, looks at the time of the compare first, from which the
/// exposure is counted, and then at its own.
///
/// Times are those of a counter of microseconds that wraps at 32 bits; a command must leave within
/// half of that (35 minutes).
///
/// ```
/// use fmc_camera::flight::shutter_output::{ShutterLevel, ShutterOutput};
/// use fmc_camera::flight::time::Time;
///
/// let mut shutter = ShutterOutput::new();
/// shutter.open(Time::from_us(5000), 0.002);
/// assert_eq!(shutter.look(4000), ShutterLevel { is_high: false, next_us: Some(5000) });
/// assert_eq!(shutter.look(5000), ShutterLevel { is_high: true, next_us: Some(7000) });
/// assert_eq!(shutter.look(7000), ShutterLevel { is_high: false, next_us: None });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShutterOutput {
    phase: Phase,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Phase {
    #[default]
    Closed,
    Waiting {
        at_us: u32,
        exposure_us: u32,
    },
    Open {
        until_us: u32,
    },
}

/// Present level of the wire, and the time of the next look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShutterLevel {
    /// `true` if the shutter is told to be open.
    pub is_high: bool,
    /// Time at which the level changes; `None` if it stays.
    pub next_us: Option<u32>,
}

impl ShutterOutput {
    /// Returns an output that tells the shutter to be closed.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            phase: Phase::Closed,
        }
    }

    /// Sets the command that is to leave at a time, for an exposure, s; it replaces one that has
    /// not left. A command whose time has passed leaves at the next look, late and with its full
    /// exposure. With an exposure that is shorter than half a microsecond, or NaN, the shutter is
    /// to stay closed.
    pub fn open(&mut self, at: Time, exposure_s: f32) {
        let [b0, b1, b2, b3, ..] = at.us().to_le_bytes();
        let exposure_us = Time::START.plus_s(exposure_s.max(0.0)).us();
        self.phase = match u32::try_from(exposure_us) {
            Ok(0) => Phase::Closed,
            exposure => Phase::Waiting {
                at_us: u32::from_le_bytes([b0, b1, b2, b3]),
                exposure_us: exposure.unwrap_or(LONGEST_US).min(LONGEST_US),
            },
        };
    }

    /// Closes the shutter at once; a command that has not left is taken back.
    pub const fn close(&mut self) {
        self.phase = Phase::Closed;
    }

    /// Returns the level of the wire from now on.
    pub const fn look(&mut self, now_us: u32) -> ShutterLevel {
        if let Phase::Waiting { at_us, exposure_us } = self.phase
            && has_come(at_us, now_us)
        {
            self.phase = Phase::Open {
                // The exposure is counted from the time at which the command leaves.
                until_us: now_us.wrapping_add(exposure_us),
            };
        }
        if let Phase::Open { until_us } = self.phase
            && has_come(until_us, now_us)
        {
            self.phase = Phase::Closed;
        }
        match self.phase {
            Phase::Closed => ShutterLevel {
                is_high: false,
                next_us: None,
            },
            Phase::Waiting { at_us, .. } => ShutterLevel {
                is_high: false,
                next_us: Some(at_us),
            },
            Phase::Open { until_us } => ShutterLevel {
                is_high: true,
                next_us: Some(until_us),
            },
        }
    }
}

/// Longest exposure, µs: a third of the counter's turn.
const LONGEST_US: u32 = u32::MAX / 3;

/// Returns `true` if a time is not in the future: nearer behind `now_us` than before it.
#[must_use]
pub const fn has_come(time_us: u32, now_us: u32) -> bool {
    now_us.wrapping_sub(time_us).cast_signed() >= 0
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOSED: ShutterLevel = ShutterLevel {
        is_high: false,
        next_us: None,
    };

    fn level(is_high: bool, next_us: u32) -> ShutterLevel {
        ShutterLevel {
            is_high,
            next_us: Some(next_us),
        }
    }

    #[test]
    fn command_leaves_at_its_time_and_ends_an_exposure_later_also_across_the_wrap() {
        let mut shutter = ShutterOutput::new();
        assert_eq!(shutter.look(0), CLOSED);
        // 1 ms before the counter wraps for the third time.
        let at = Time::from_us((3 << 32) - 1000);
        let at_us = u32::MAX - 999;
        shutter.open(at, 2.5e-3);
        assert_eq!(shutter.look(at_us - 1), level(false, at_us));
        assert_eq!(shutter.look(at_us), level(true, 1500));
        assert_eq!(shutter.look(u32::MAX), level(true, 1500));
        assert_eq!(shutter.look(1499), level(true, 1500));
        assert_eq!(shutter.look(1500), CLOSED);
        assert_eq!(shutter.look(1501), CLOSED);
    }

    #[test]
    fn command_whose_time_has_passed_leaves_at_once_and_lasts_as_long() {
        let mut shutter = ShutterOutput::new();
        shutter.open(Time::from_us(1000), 1e-3);
        assert_eq!(shutter.look(1700), level(true, 2700));
        assert_eq!(shutter.look(2700), CLOSED);
        // Even a command that would have ended by now leaves: the controller judges it.
        shutter.open(Time::from_us(5000), 1e-3);
        assert_eq!(shutter.look(9000), level(true, 10_000));
    }

    #[test]
    fn exposure_is_counted_from_the_compare_that_the_timer_has_made() {
        let mut shutter = ShutterOutput::new();
        shutter.open(Time::from_us(1000), 1e-3);
        assert_eq!(shutter.look(1000), level(true, 2000));
        assert_eq!(shutter.look(1300), level(true, 2000));
        // A command that came between the two takes the place of the one that was set.
        shutter.open(Time::from_us(4000), 1e-3);
        assert_eq!(shutter.look(1301), level(false, 4000));
    }

    #[test]
    fn close_takes_a_command_back_and_ends_one_that_has_left() {
        let mut shutter = ShutterOutput::new();
        shutter.open(Time::from_us(1000), 1e-3);
        shutter.close();
        assert_eq!(shutter.look(1000), CLOSED);
        shutter.open(Time::from_us(2000), 1e-3);
        assert_eq!(shutter.look(2000), level(true, 3000));
        shutter.close();
        assert_eq!(shutter.look(2001), CLOSED);
        assert_eq!(shutter.look(3000), CLOSED);
    }

    #[test]
    fn exposure_that_is_none_opens_nothing() {
        let mut shutter = ShutterOutput::new();
        for exposure_s in [0.0, -1.0, f32::NAN, 4e-7] {
            shutter.open(Time::from_us(1000), exposure_s);
            assert_eq!(shutter.look(1000), CLOSED, "{exposure_s} s");
        }
        shutter.open(Time::from_us(1000), f32::INFINITY);
        assert_eq!(shutter.look(1000), level(true, 1000 + LONGEST_US));
    }
}
