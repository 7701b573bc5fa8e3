//! Means over repetitions, with confidence intervals.

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF, StudentsT};

/// Probability that an interval of this module holds the true value.
pub const CONFIDENCE: f64 = 0.95;

/// A value and the interval that holds the true one with probability [`CONFIDENCE`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Best estimate.
    pub value: f64,
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

impl Estimate {
    /// Returns the mean of independent samples with Student's t interval; the interval is infinite
    /// for fewer than two samples.
    #[must_use]
    pub fn of_mean(samples: &[f64]) -> Self {
        let count = f64::from(u32::try_from(samples.len()).unwrap_or(u32::MAX));
        let mean = samples.iter().sum::<f64>() / count;
        let squares: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
        let half = match StudentsT::new(0.0, 1.0, count - 1.0) {
            Ok(student) if samples.len() > 1 => {
                student.inverse_cdf(0.5 + CONFIDENCE / 2.0)
                    * (squares / (count - 1.0) / count).sqrt()
            }
            _ => f64::INFINITY,
        };
        Self {
            value: mean,
            lower: mean - half,
            upper: mean + half,
        }
    }

    /// Returns the ratio of two positive quantities observed in pairs, with the t interval of its
    /// logarithm.
    #[must_use]
    pub fn of_ratio(numerators: &[f64], denominators: &[f64]) -> Self {
        let logarithms: Vec<f64> = numerators
            .iter()
            .zip(denominators)
            .map(|(numerator, denominator)| (numerator / denominator).ln())
            .collect();
        let Self {
            value,
            lower,
            upper,
        } = Self::of_mean(&logarithms);
        Self {
            value: value.exp(),
            lower: lower.exp(),
            upper: upper.exp(),
        }
    }

    /// Returns a probability from `hits` in `trials`, with the exact interval of Clopper and
    /// Pearson (1934), which holds it with the probability `confidence`.
    #[must_use]
    pub fn of_probability(hits: u32, trials: u32, confidence: f64) -> Self {
        let misses = f64::from(trials.saturating_sub(hits));
        let (hits, trials) = (f64::from(hits), f64::from(trials));
        let tail = (1.0 - confidence) / 2.0;
        let quantile = |a: f64, b: f64, probability: f64, otherwise: f64| {
            Beta::new(a, b).map_or(otherwise, |beta| beta.inverse_cdf(probability))
        };
        Self {
            value: hits / trials,
            lower: quantile(hits, misses + 1.0, tail, 0.0),
            upper: quantile(hits + 1.0, misses, 1.0 - tail, 1.0),
        }
    }

    /// Returns true if the interval holds a value.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interval_of_a_mean_is_students() {
        // Mean 3, variance 2.5, t(4; 0.975) = 2.7764.
        let estimate = Estimate::of_mean(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert!((estimate.value - 3.0).abs() < 1e-12);
        assert!((estimate.upper - 3.0 - 2.776_445 * 0.5_f64.sqrt()).abs() < 1e-5);
        assert!(Estimate::of_mean(&[1.0]).upper.is_infinite());
    }

    #[test]
    fn ratio_of_pairs_leaves_out_what_they_share() {
        let shared = [1.0, 3.0, 9.0, 0.2];
        let halves = shared.map(|value| 0.5 * value);
        let ratio = Estimate::of_ratio(&halves, &shared);
        assert!((ratio.lower - 0.5).abs() < 1e-9 && (ratio.upper - 0.5).abs() < 1e-9);
    }

    #[test]
    fn interval_of_a_probability_is_clopper_and_pearsons() {
        // Tabulated for 10 in 20: 0.272 to 0.728; for 0 in 20: up to 0.168.
        let half = Estimate::of_probability(10, 20, 0.95);
        assert!((half.lower - 0.272).abs() < 1e-3 && (half.upper - 0.728).abs() < 1e-3);
        let none = Estimate::of_probability(0, 20, 0.95);
        assert!(none.lower <= 0.0 && (none.upper - 0.168).abs() < 1e-3);
        assert!(Estimate::of_probability(20, 20, 0.95).upper >= 1.0);
    }
}
