//! Slope of a quantity over time.

use heapless::Deque;

use super::time::Time;

/// Number of values by which the slope is measured.
pub(crate) const VALUES: usize = 4;

/// Slope that rounding to steps makes of a straight line through [`VALUES`] values at equal
/// intervals, in steps per interval, as 3 σ.
///
/// A rounded value has the variance 1/12; the line of least squares through n values has that of
/// the slope `12/(n(n² - 1))` times as large, 1/5 for four.
pub(crate) const SLOPE_STEPS: f32 = 0.388;

/// The slope of the latest values.
#[derive(Debug, Clone, Default)]
pub(crate) struct Slope {
    latest: Deque<(Time, f32), VALUES>,
}

impl Slope {
    /// Returns a slope without values.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self {
            latest: Deque::new(),
        }
    }

    /// Takes a value.
    pub(crate) fn push(&mut self, time: Time, value: f32) {
        if self.latest.is_full() {
            self.latest.pop_front();
        }
        // There is room now.
        let _ = self.latest.push_back((time, value));
    }

    /// Forgets all values.
    pub(crate) fn clear(&mut self) {
        self.latest.clear();
    }

    /// Returns the slope of the line of least squares through the last [`VALUES`] values, per
    /// second; `None` before there are as many, or if their times are equal.
    #[must_use]
    pub(crate) fn per_s(&self) -> Option<f32> {
        let (first_time, first_value) = *self.latest.front()?;
        if !self.latest.is_full() {
            return None;
        }
        let relative = || {
            self.latest
                .iter()
                .map(|(time, value)| (time.seconds_since(first_time), value - first_value))
        };
        let (mut time_sum, mut value_sum, mut count) = (0.0, 0.0, 0.0);
        for (time_s, value) in relative() {
            time_sum += time_s;
            value_sum += value;
            count += 1.0;
        }
        let (mean_s, mean) = (time_sum / count, value_sum / count);
        let (mut covariance, mut variance) = (0.0, 0.0);
        for (time_s, value) in relative() {
            covariance += (time_s - mean_s) * (value - mean);
            variance += (time_s - mean_s) * (time_s - mean_s);
        }
        (variance > 0.0).then(|| covariance / variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slope_is_that_of_the_latest_values() {
        let mut slope = Slope::new();
        slope.push(Time::START, 1000.0);
        for tick in 1..=4_u8 {
            assert_eq!(slope.per_s().is_some(), tick == 4);
            slope.push(
                Time::from_us(1000 * u64::from(tick)),
                7.0 - 0.02 * f32::from(tick),
            );
        }
        assert!((slope.per_s().unwrap() + 20.0).abs() < 1e-2);
        let variance_of_slope = 1.0 / 12.0 / 5.0_f32;
        assert!((SLOPE_STEPS - 3.0 * libm::sqrtf(variance_of_slope)).abs() < 1e-3);
        slope.clear();
        assert_eq!(slope.per_s(), None);
        for _ in 0..VALUES {
            slope.push(Time::START, 1.0);
        }
        assert_eq!(slope.per_s(), None);
    }
}
