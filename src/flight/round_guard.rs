//! Guard of the control loop's rounds, asked from an interrupt.

use core::sync::atomic::{AtomicU32, Ordering};

/// Longest time from one round to the next with force on the stage, µs: longer than any round of a
/// loop that works, and short enough that a stage under full force stays within its end stops.
pub const LONGEST_ROUND_US: u32 = 5000;

/// Tells an interrupt to take the force off when rounds fail to come.
#[derive(Debug, Default)]
pub struct RoundGuard {
    last_us: AtomicU32,
}

impl RoundGuard {
    /// Returns a guard before the first round.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            last_us: AtomicU32::new(0),
        }
    }

    /// Notes a round of the control loop, at this count of microseconds.
    pub fn come_round(&self, now_us: u32) {
        self.last_us.store(now_us, Ordering::Relaxed);
    }

    /// Returns `true` if the last round is longer ago than [`LONGEST_ROUND_US`]. It must be asked
    /// more often than the counter turns.
    pub fn is_overdue(&self, now_us: u32) -> bool {
        now_us.wrapping_sub(self.last_us.load(Ordering::Relaxed)) > LONGEST_ROUND_US
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_that_fail_to_come_are_seen_within_five_ms_also_across_the_wrap() {
        let guard = RoundGuard::new();
        for start in [0, 1_000_000, u32::MAX - 2000] {
            guard.come_round(start);
            assert!(!guard.is_overdue(start));
            assert!(!guard.is_overdue(start.wrapping_add(5000)));
            assert!(guard.is_overdue(start.wrapping_add(5001)));
        }
    }
}
