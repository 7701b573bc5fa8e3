//! Spread of V/H over the last half minute.

use crate::flight::time::Time;

/// Time between two values, s.
const EVERY_S: f32 = 0.5;

/// Number of values over which mean and spread are averaged.
const AVERAGED_VALUES: f32 = 60.0;

/// Spread before the first value, as a part of V/H, where no ground speed is known: that of
/// [`PRIOR_GUST_M_S`] at 56 m/s.
const PRIOR: f32 = 0.024;

/// σ of the gusts before the first value, m/s. Their σ lies evenly between 0 and 2 m/s from day to
/// day; 2.45 times this is what 95 % of the gusts do not exceed, of all days together.
const PRIOR_GUST_M_S: f32 = 1.35;

/// Number of values that the prior counts as before the first value, and the number of values after
/// which it counts half: gusts last for seconds, and the first values show little of them.
const PRIOR_VALUES: f32 = 30.0;
const PRIOR_FADES_BY: f32 = 10.0;

/// Mean of V/H and its spread about it.
///
/// # Model
/// V/H below the aircraft varies as gusts change the speed along the track and the ground changes
/// the height. Gusts across the track are as strong, and the ground elsewhere in the picture lies
/// as much higher or lower, so that the spread is also that of the image motion that a
/// compensation for V/H below the aircraft leaves.
///
/// Values of a few seconds lie in the same gust: their variance says little of the gusts to come.
/// It is averaged with a first guess, gusts of [`PRIOR_GUST_M_S`] over the ground speed, which
/// counts as `w = 30/(1 + n/10)` values beside n measured ones:
/// `s² = (w·s₀² + n·s_n²)/(w + n)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spread {
    heard: Time,
    values: f32,
    mean: f32,
    variance: f32,
    /// The squared spread, as a part of the square of V/H.
    relative_variance: f32,
}

impl Spread {
    pub(super) const NEW: Self = Self {
        heard: Time::START,
        values: 0.0,
        mean: 0.0,
        variance: 0.0,
        relative_variance: PRIOR * PRIOR,
    };

    /// Takes a V/H, 1/s, at a ground speed, m/s.
    pub(super) fn take(&mut self, now: Time, vh_per_s: f32, speed_m_s: Option<f32>) {
        if self.values > 0.0 && now.seconds_since(self.heard) < EVERY_S {
            return;
        }
        self.heard = now;
        self.values = (self.values + 1.0).min(AVERAGED_VALUES);
        let part = 1.0 / self.values;
        let difference = vh_per_s - self.mean;
        self.mean += part * difference;
        self.variance = (1.0 - part) * (self.variance + part * difference * difference);
        let guess = speed_m_s.map_or(PRIOR, |speed_m_s| PRIOR_GUST_M_S / speed_m_s);
        let prior = PRIOR_VALUES * PRIOR_FADES_BY / (PRIOR_FADES_BY + self.values);
        let measured = self.variance / (self.mean * self.mean);
        self.relative_variance =
            (prior * guess * guess + self.values * measured) / (prior + self.values);
    }

    /// The squared spread, as a part of the square of V/H.
    pub(super) const fn relative_variance(&self) -> f32 {
        self.relative_variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the spread after so many even values, one each half second, as a part of V/H.
    fn calm(values: u16, speed_m_s: Option<f32>) -> f32 {
        let mut spread = Spread::NEW;
        let mut now = Time::START;
        for _ in 0..values {
            now = now.plus_s(EVERY_S);
            spread.take(now, 0.05, speed_m_s);
        }
        libm::sqrtf(spread.relative_variance())
    }

    fn assert_near(found: f32, expected: f32) {
        assert!((found / expected - 1.0).abs() < 1e-3, "{found}: {expected}");
    }

    #[test]
    fn first_guess_is_gusts_over_the_ground_speed() {
        assert_near(calm(0, None), PRIOR);
        // 30/(1 + 1/10) values beside one.
        let part = libm::sqrtf(27.273 / 28.273);
        assert_near(calm(1, None), part * PRIOR);
        assert_near(calm(1, Some(40.0)), part * PRIOR_GUST_M_S / 40.0);
    }

    #[test]
    fn guess_is_most_of_the_first_seconds_and_little_of_a_minute() {
        // Two seconds: 21.4 values beside 4. Half a minute: 4.3 beside 60.
        assert_near(calm(4, None), PRIOR * libm::sqrtf(21.4286 / 25.4286));
        assert_near(calm(60, None), PRIOR * libm::sqrtf(4.2857 / 64.2857));
    }

    #[test]
    fn spread_is_that_of_the_values_in_the_end() {
        let mut spread = Spread::NEW;
        let mut now = Time::START;
        for round in 0..200_u16 {
            now = now.plus_s(EVERY_S);
            let sign = if round % 2 == 0 { 1.0 } else { -1.0 };
            spread.take(now, 0.05 * (1.0 + 0.03 * sign), Some(100.0));
        }
        let found = libm::sqrtf(spread.relative_variance());
        assert!((0.028..0.031).contains(&found), "{found}");
    }
}
