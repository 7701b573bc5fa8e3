//! Spread of V/H over the last half minute.

use crate::flight::time::Time;

/// Time between two values, s.
const EVERY_S: f32 = 0.5;

/// Number of values over which mean and spread are averaged.
const AVERAGED_VALUES: f32 = 60.0;

/// Spread before the first value, as a part of V/H, and the number of values it counts as.
const PRIOR: f32 = 0.015;
const PRIOR_VALUES: f32 = 3.0;

/// Mean of V/H and its spread about it.
///
/// # Model
/// V/H below the aircraft varies as gusts change the speed along the track and the ground changes
/// the height. Gusts across the track are as strong, and the ground elsewhere in the picture lies
/// as much higher or lower, so that the spread is also that of the image motion that a
/// compensation for V/H below the aircraft leaves.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spread {
    heard: Time,
    values: f32,
    mean: f32,
    variance: f32,
}

impl Spread {
    pub(super) const NEW: Self = Self {
        heard: Time::START,
        values: 0.0,
        mean: 0.0,
        variance: 0.0,
    };

    /// Takes a V/H, 1/s.
    pub(super) fn take(&mut self, now: Time, vh_per_s: f32) {
        if self.values > 0.0 && now.seconds_since(self.heard) < EVERY_S {
            return;
        }
        self.heard = now;
        self.values = (self.values + 1.0).min(AVERAGED_VALUES);
        let part = 1.0 / self.values;
        let difference = vh_per_s - self.mean;
        self.mean += part * difference;
        self.variance = (1.0 - part) * (self.variance + part * difference * difference);
    }

    /// The squared spread, as a part of the square of V/H.
    pub(super) fn relative_variance(&self) -> f32 {
        let prior = PRIOR_VALUES * PRIOR * PRIOR;
        if self.mean > 0.0 {
            let measured = self.variance / (self.mean * self.mean);
            (prior + self.values * measured) / (PRIOR_VALUES + self.values)
        } else {
            PRIOR * PRIOR
        }
    }
}
