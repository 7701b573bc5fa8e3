//! Coverage of a σ: how errors are distributed in units of the σ that goes with them.

use serde::Serialize;
use statrs::distribution::{Beta, ChiSquared, ContinuousCDF};

/// Probability with which a right σ fails one check.
pub const FALSE_ALARM: f64 = 1e-3;

/// Largest lag of the autocorrelation, frames.
const LARGEST_LAG: usize = 5000;

/// Distribution of errors in units of their σ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coverage {
    /// Number of errors.
    pub frames: usize,
    /// Number of independent errors that say as much as they do.
    pub independent: f64,
    /// Root mean square of error/σ.
    pub rms: f64,
    /// Largest absolute error/σ.
    pub largest: f64,
    /// Number of errors beyond 3 σ.
    pub beyond_3: usize,
    /// Number of errors beyond 5 σ.
    pub beyond_5: usize,
}

impl Coverage {
    /// Computes the distribution of errors of one flight, in order of time; `None` without errors.
    ///
    /// # Model
    /// Errors of one flight may have a common part, such as the encoder's phase, so that their
    /// number says less than it seems. The number of independent errors is n/τ, with the
    /// integrated autocorrelation time τ about the mean 0 by the initial positive sequence (Geyer,
    /// Statistical Science 7 (1992) 473, section 3.3).
    #[must_use]
    pub fn of(ratios: &[f64]) -> Option<Self> {
        let mut coverage = Self::of_independent(ratios)?;
        coverage.independent = independent(ratios);
        Some(coverage)
    }

    /// Computes the distribution of errors that have no common part; `None` without errors.
    #[must_use]
    pub fn of_independent(ratios: &[f64]) -> Option<Self> {
        if ratios.is_empty() {
            return None;
        }
        let squares: f64 = ratios.iter().map(|ratio| ratio * ratio).sum();
        let is_beyond = |ratio: f64, sigmas: f64| ratio.is_nan() || ratio.abs() > sigmas;
        let beyond = |sigmas| {
            ratios
                .iter()
                .filter(|ratio| is_beyond(**ratio, sigmas))
                .count()
        };
        Some(Self {
            frames: ratios.len(),
            independent: number(ratios.len()),
            rms: (squares / number(ratios.len())).sqrt(),
            largest: ratios.iter().map(|ratio| ratio.abs()).fold(0.0, f64::max),
            beyond_3: beyond(3.0),
            beyond_5: beyond(5.0),
        })
    }

    /// Returns the largest root mean square that so many errors have by chance where that of all
    /// flights is `of_all`: the bound of χ² that a right σ exceeds with [`FALSE_ALARM`].
    #[must_use]
    pub fn largest_rms(&self, of_all: f64) -> f64 {
        ChiSquared::new(self.independent).map_or(f64::NAN, |squares| {
            of_all * (squares.inverse_cdf(1.0 - FALSE_ALARM) / self.independent).sqrt()
        })
    }

    /// Returns true if the root mean square and the shares beyond 3 σ and 5 σ can be those of a
    /// right σ, whose root mean square and shares over all flights are at most these.
    #[must_use]
    pub fn is_credible(&self, largest_rms: f64, [beyond_3, beyond_5]: [f64; 2]) -> bool {
        let can_be = |count: usize, share: f64| {
            let part = number(count) / number(self.frames);
            can_be_chance(part * self.independent, self.independent, share)
        };
        self.rms <= self.largest_rms(largest_rms)
            && can_be(self.beyond_3, beyond_3)
            && can_be(self.beyond_5, beyond_5)
    }
}

/// Returns true if so many cases of n may be there by chance, each with at most this probability:
/// as many or more are more probable than [`FALSE_ALARM`].
///
/// # Model
/// The upper tail of the binomial distribution, which is the regularised incomplete beta function
/// `I_p(k, n - k + 1)`; k and n need not be whole. Less than one case is none.
#[must_use]
pub fn can_be_chance(cases: f64, of: f64, probability: f64) -> bool {
    if cases <= 0.0 {
        return true;
    }
    let cases = cases.max(1.0).min(of);
    Beta::new(cases, of - cases + 1.0).is_ok_and(|tail| tail.cdf(probability) >= FALSE_ALARM)
}

/// Returns the number of independent values that say as much as a series about its mean, 0.
#[must_use]
pub fn independent(series: &[f64]) -> f64 {
    let squares: f64 = series.iter().map(|value| value * value).sum();
    let count = number(series.len());
    if !(squares > 0.0 && squares.is_finite()) {
        return count.max(1.0);
    }
    let correlation = |lag: usize| {
        let pairs = series.iter().zip(series.iter().skip(lag));
        pairs.map(|(one, other)| one * other).sum::<f64>() / squares
    };
    let pairs = (0..series.len().min(LARGEST_LAG))
        .step_by(2)
        .map(|lag| correlation(lag) + correlation(lag + 1))
        .take_while(|pair| *pair > 0.0);
    let time = 2.0 * pairs.sum::<f64>() - 1.0;
    (count / time.max(1.0)).max(1.0)
}

fn number(count: usize) -> f64 {
    u32::try_from(count).map_or(f64::INFINITY, f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    fn normal(count: usize, sigma: f64) -> Vec<f64> {
        let mut noise = Noise::new(3, 9);
        (0..count).map(|_| noise.next([sigma])[0]).collect()
    }

    #[test]
    fn errors_of_a_right_sigma_are_credible_and_those_of_one_too_small_are_not() {
        let share = [0.003, 6e-7];
        for count in [50, 200, 2000] {
            let right = Coverage::of(&normal(count, 1.0)).unwrap();
            assert!(right.is_credible(1.2, share), "{right:?}");
            let wrong = Coverage::of(&normal(count, 2.4)).unwrap();
            assert!(!wrong.is_credible(1.2, share), "{wrong:?}");
        }
        assert_eq!(Coverage::of(&[]), None);
    }

    #[test]
    fn error_of_a_whole_flight_counts_once() {
        // An error of 2 σ that all frames share: one draw of it is no evidence, 20 flights are.
        let common = Coverage::of(&[2.0; 400]).unwrap();
        assert!(common.independent < 3.0, "{common:?}");
        assert!(common.is_credible(1.2, [0.003, 6e-7]));
        let flights = Coverage::of_independent(&[2.0; 20]).unwrap();
        assert!(!flights.is_credible(1.2, [0.003, 6e-7]));
        let white = independent(&normal(1000, 1.0));
        assert!(white > 700.0, "{white}");
    }

    #[test]
    fn tail_is_that_of_the_binomial_distribution() {
        // P(X ≥ 2) of 24 with 0.0027 is 0.0019, P(X ≥ 3) is 4e-5.
        assert!(can_be_chance(2.0, 24.0, 0.0027) && !can_be_chance(3.0, 24.0, 0.0027));
        assert!(can_be_chance(0.0, 24.0, 6e-7) && !can_be_chance(1.0, 24.0, 6e-7));
        assert!(can_be_chance(1.0, 1.0, 0.5));
    }

    #[test]
    fn error_that_is_no_number_is_beyond_every_sigma() {
        let coverage = Coverage::of(&[0.1, f64::NAN, f64::INFINITY]).unwrap();
        assert_eq!((coverage.beyond_3, coverage.beyond_5), (2, 2));
        assert!(!coverage.is_credible(1.2, [0.003, 6e-7]));
    }
}
