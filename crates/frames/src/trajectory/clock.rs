//! Times of trajectory and exposures on one scale.

use crate::time;

/// Length of a week, s.
pub(super) const WEEK_S: f64 = 604_800.0;

/// Time scale of the seconds of a week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TimeScale {
    /// GPS time.
    #[default]
    Gps,
    /// UTC, with weeks from Sunday to Sunday.
    Utc,
}

impl TimeScale {
    /// Returns the name that messages use.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gps => "GPS",
            Self::Utc => "UTC",
        }
    }
}

/// Scale of the times of a trajectory: seconds since the week began in which it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Clock {
    pub(super) scale: TimeScale,
    /// The week, where the file states it.
    pub(super) week: Option<u64>,
}

impl Clock {
    /// Returns the time of an instant of UTC, s; `None` before GPS time began.
    ///
    /// Without a week in the file, the exposure is in the week of the trajectory, or in the next if
    /// only then the time is not before `first_s`.
    pub(super) fn seconds(&self, unix_us: u64, first_s: f64) -> Option<f64> {
        let instant = match self.scale {
            TimeScale::Gps => time::gps(unix_us)?,
            TimeScale::Utc => time::utc_week(unix_us)?,
        };
        let seconds = instant.seconds();
        match self.week {
            Some(week) => Some(weeks_s(instant.week, week) + seconds),
            None if seconds < first_s && first_s - seconds > WEEK_S / 2.0 => Some(seconds + WEEK_S),
            None => Some(seconds),
        }
    }
}

/// Returns the seconds from the beginning of a week to that of another.
pub(super) fn weeks_s(week: u64, since: u64) -> f64 {
    let count = |week: u64| u32::try_from(week).map_or(f64::INFINITY, f64::from);
    (count(week) - count(since)) * WEEK_S
}

/// Seconds of a week that go on where the week turns.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct WeekCount {
    /// Seconds to be added.
    pub(super) added_s: f64,
    last_s: Option<f64>,
}

impl WeekCount {
    pub(super) const fn from(added_s: f64) -> Self {
        Self {
            added_s,
            last_s: None,
        }
    }

    /// Returns the time of a second of the week: a step back by more than half a week is the turn
    /// of the week.
    pub(super) fn time_s(&mut self, seconds: f64) -> f64 {
        if self
            .last_s
            .is_some_and(|last| last - seconds > WEEK_S / 2.0)
        {
            self.added_s += WEEK_S;
        }
        self.last_s = Some(seconds);
        seconds + self.added_s
    }
}
