//! Turbulence: a seeded random process of a stated spectrum.

use std::f64::consts::{FRAC_PI_2, TAU};

use fastrand::Rng;

/// Number of waves that a process is the sum of.
const WAVES: u8 = 32;

/// Strength and bandwidth of a process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Standard deviation, in the unit of the process.
    pub rms: f64,
    /// Frequency below which half of the variance lies, Hz.
    pub corner_hz: f64,
}

/// A stationary random process in time; the same seed gives the same process.
///
/// # Model
/// One-sided power density `S(f) = 2σ²/(π·f_c) / (1 + (f/f_c)²)`: a first-order low-pass, the form
/// of Dryden's longitudinal gusts. The process is the sum of 32 waves of the amplitude σ·√(2/32)
/// and random phase, one in each of 32 bands of equal variance; the highest frequency is at most
/// 82·`f_c`.
///
/// # Examples
/// ```
/// use fmc_simulation::scene::turbulence::{Spectrum, Turbulence};
/// let gusts = Turbulence::new(Spectrum { rms: 0.5, corner_hz: 0.2 }, 7);
/// assert_eq!(gusts.value(1.0), Turbulence::new(Spectrum { rms: 0.5, corner_hz: 0.2 }, 7).value(1.0));
/// assert_eq!(Turbulence::still().value(1.0), 0.0);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Turbulence {
    waves: Vec<Wave>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave {
    amplitude: f64,
    /// Angular frequency, rad/s.
    angular: f64,
    /// Phase, rad.
    phase: f64,
}

impl Turbulence {
    /// Creates a process that is always 0.
    #[must_use]
    pub const fn still() -> Self {
        Self { waves: Vec::new() }
    }

    /// Creates the process of a spectrum and a seed.
    #[must_use]
    pub fn new(spectrum: Spectrum, seed: u64) -> Self {
        let mut random = Rng::with_seed(seed);
        let bands = f64::from(WAVES);
        let waves = (0..WAVES).map(|band| {
            // The share of the variance below f is 2/π·atan(f/f_c).
            let share = (f64::from(band) + random.f64()) / bands;
            let share = share.min(1.0 - 0.25 / bands);
            Wave {
                amplitude: spectrum.rms * (2.0 / bands).sqrt(),
                angular: TAU * spectrum.corner_hz * (FRAC_PI_2 * share).tan(),
                phase: TAU * random.f64(),
            }
        });
        Self {
            waves: waves.collect(),
        }
    }

    /// Removes the waves below a frequency, Hz, as a mount that levels the camera does.
    #[must_use]
    pub fn above(mut self, lowest_hz: f64) -> Self {
        self.waves.retain(|wave| wave.angular >= TAU * lowest_hz);
        self
    }

    /// Returns the process at a time, s.
    #[must_use]
    pub fn value(&self, time_s: f64) -> f64 {
        self.waves
            .iter()
            .map(|wave| wave.amplitude * (wave.angular * time_s + wave.phase).cos())
            .sum()
    }

    /// Returns the integral of the process from 0 to a time, s.
    #[must_use]
    pub fn integral(&self, time_s: f64) -> f64 {
        self.waves
            .iter()
            .map(|wave| {
                // sin(ωt + φ) - sin φ, without the loss of digits where ωt is small.
                let half = 0.5 * wave.angular * time_s;
                let mean = if half.abs() < 1e-9 {
                    time_s
                } else {
                    time_s * half.sin() / half
                };
                wave.amplitude * mean * (half + wave.phase).cos()
            })
            .sum()
    }

    /// Highest frequency of the process, Hz.
    #[must_use]
    pub fn highest_hz(&self) -> f64 {
        self.waves
            .iter()
            .map(|wave| wave.angular / TAU)
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECTRUM: Spectrum = Spectrum {
        rms: 0.3,
        corner_hz: 0.5,
    };

    #[test]
    fn variance_is_that_of_the_spectrum_half_of_it_below_the_corner() {
        for seed in 0..4 {
            let process = Turbulence::new(SPECTRUM, seed);
            let samples: Vec<f64> = (0..100_000)
                .map(|step| process.value(0.037 * f64::from(step)))
                .collect();
            let mean_square = samples.iter().map(|value| value * value).sum::<f64>() / 1e5;
            assert!(
                (mean_square.sqrt() / 0.3 - 1.0).abs() < 0.03,
                "{mean_square}"
            );
            let slow = process
                .waves
                .iter()
                .filter(|wave| wave.angular < TAU * 0.5)
                .count();
            assert_eq!(slow, 16);
        }
    }

    #[test]
    fn integral_is_that_of_the_process() {
        let process = Turbulence::new(SPECTRUM, 3);
        assert!(process.integral(0.0).abs() < 1e-15);
        for time in [-2.0, 0.1, 4.0] {
            let slope = (process.integral(time + 1e-4) - process.integral(time - 1e-4)) / 2e-4;
            assert!((slope - process.value(time)).abs() < 1e-4);
        }
    }

    #[test]
    fn integral_of_a_process_above_a_frequency_stays_small() {
        let levelled = Turbulence::new(SPECTRUM, 3).above(0.1);
        let slow = TAU * 0.1;
        assert!(levelled.waves.iter().all(|wave| wave.angular >= slow));
        assert!(levelled.waves.len() > 20);
        // The angle of each wave alone is at most twice its amplitude over ω.
        let most: f64 = levelled
            .waves
            .iter()
            .map(|wave| 2.0 * wave.amplitude / wave.angular)
            .sum();
        for hour in 0..5 {
            assert!(levelled.integral(3600.0 * f64::from(hour)).abs() <= most);
        }
    }

    #[test]
    fn seeds_differ() {
        let at = |seed| Turbulence::new(SPECTRUM, seed).value(1.0);
        assert!((at(1) - at(2)).abs() > 1e-6);
    }
}
