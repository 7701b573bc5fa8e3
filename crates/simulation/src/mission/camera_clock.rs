//! The camera's clock, which is not quite the world's.

use super::clock::{microseconds, seconds};
use super::file::ClockTable;
use crate::scene::turbulence::{Spectrum, Turbulence};

/// Steps of the inverse; each is closer by the clock's relative error, less than 1e-3.
const STEPS: usize = 3;

/// The camera's clock: its rate is off by a drift, and wanders.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraClock {
    /// Excess of the rate, relative.
    drift: f64,
    /// Excess of the rate that changes, ppm.
    wander: Option<Turbulence>,
}

impl CameraClock {
    /// Creates the clock of a scenario.
    #[must_use]
    pub fn of(table: &ClockTable, seed: u64) -> Self {
        Self {
            drift: 1e-6 * table.drift_ppm,
            wander: (table.wander_ppm > 0.0).then(|| {
                let spectrum = Spectrum {
                    rms: table.wander_ppm,
                    corner_hz: table.wander_corner_hz,
                };
                // Distinct from the seeds of the air.
                Turbulence::new(spectrum, seed.wrapping_mul(64).wrapping_add(7))
            }),
        }
    }

    fn is_exact(&self) -> bool {
        self.drift == 0.0 && self.wander.is_none()
    }

    /// Returns the excess of the clock at a true time, s.
    fn excess_s(&self, time_s: f64) -> f64 {
        let wander = self.wander.as_ref();
        let wandered = wander.map_or(0.0, |wander| wander.integral(time_s) - wander.integral(0.0));
        self.drift * time_s + 1e-6 * wandered
    }

    /// Returns the time of the clock at a true time, s.
    #[must_use]
    pub fn shown_s(&self, time_s: f64) -> f64 {
        time_s + self.excess_s(time_s)
    }

    /// Returns the stamp of a true time, µs.
    #[must_use]
    pub fn stamp_us(&self, time_us: u64) -> u64 {
        if self.is_exact() {
            return time_us;
        }
        microseconds(self.shown_s(seconds(time_us)))
    }

    /// Returns the true time at which the clock shows a time, µs.
    #[must_use]
    pub fn true_us(&self, shown_us: u64) -> u64 {
        if self.is_exact() {
            return shown_us;
        }
        let shown_s = seconds(shown_us);
        let time_s = (0..STEPS).fold(shown_s, |time_s, _| shown_s - self.excess_s(time_s));
        microseconds(time_s.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(drift_ppm: f64, wander_ppm: f64) -> CameraClock {
        let table = ClockTable {
            drift_ppm,
            wander_ppm,
            wander_corner_hz: 0.01,
        };
        CameraClock::of(&table, 5)
    }

    #[test]
    fn clock_without_error_changes_no_time() {
        let exact = clock(0.0, 0.0);
        assert_eq!(
            (exact.stamp_us(123_457), exact.true_us(123_457)),
            (123_457, 123_457)
        );
    }

    #[test]
    fn clock_gains_its_drift_and_its_stamps_lead_back() {
        assert_eq!(clock(20.0, 0.0).stamp_us(100_000_000), 100_002_000);
        let wandering = clock(-35.0, 2.0);
        for time_us in [0, 1_000_000, 77_000_001, 900_000_000] {
            let back = wandering.true_us(wandering.stamp_us(time_us));
            assert!(back.abs_diff(time_us) <= 1, "{time_us}: {back}");
        }
        let apart = wandering
            .stamp_us(900_000_000)
            .abs_diff(900_000_000 - 31_500);
        assert!(apart > 10 && apart < 2000, "{apart}");
    }
}
