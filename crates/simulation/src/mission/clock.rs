//! Simulated time: microseconds since the flight began.

/// Period of the control loop, µs.
pub const ROUND_US: u64 = 1000;

/// An event that recurs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clocked {
    /// Time from one event to the next, µs.
    pub(super) period_us: u64,
    /// Time of the next event, µs.
    pub(super) next_us: u64,
}

/// Converts seconds into whole microseconds.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates; times of a flight are not negative"
)]
pub(crate) fn microseconds(seconds: f64) -> u64 {
    (1e6 * seconds).round() as u64
}

/// Converts microseconds into seconds.
#[expect(
    clippy::cast_precision_loss,
    reason = "a flight is shorter than 2^53 µs"
)]
pub(crate) fn seconds(us: u64) -> f64 {
    us as f64 * 1e-6
}

/// Adds the error of a stamp, which is never before 0, µs.
pub(super) fn jittered(time_us: u64, jitter_us: f64) -> u64 {
    let late_us = microseconds(1e-6 * jitter_us.max(0.0));
    let early_us = microseconds(1e-6 * (-jitter_us).max(0.0));
    (time_us + late_us).saturating_sub(early_us)
}
