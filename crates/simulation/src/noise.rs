//! Seeded Gaussian noise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// Source of normal deviates.
///
/// The generator is `ChaCha` with 8 rounds, whose output is the same on every machine. Deviates
/// come from the ziggurat method of `rand_distr` with functions of `libm`.
#[derive(Debug, Clone)]
pub struct Noise(ChaCha8Rng);

impl Noise {
    /// Creates one of the 2⁶⁴ independent sources of a seed.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// Returns the next deviates, each with the given standard deviation.
    pub fn next<const N: usize>(&mut self, sigmas: [f64; N]) -> [f64; N] {
        sigmas.map(|sigma| {
            let deviate: f64 = StandardNormal.sample(&mut self.0);
            sigma * deviate
        })
    }

    /// Returns the next number that is evenly distributed from `least` to `most`.
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        let part: f64 = StandardUniform.sample(&mut self.0);
        least + (most - least) * part
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviates_have_the_standard_deviation_asked_for() {
        let mut noise = Noise::new(1, 2);
        let squares: f64 = (0..20_000)
            .map(|_| noise.next([3.0])[0].powi(2))
            .sum::<f64>()
            / 20_000.0;
        // Four standard errors of a variance from 20 000 deviates.
        assert!((squares / 9.0 - 1.0).abs() < 0.04, "{squares}");
    }

    #[test]
    fn noise_of_a_seed_never_changes() {
        let text = format!("{:.12?}", Noise::new(1, 0).next([1.0; 2]));
        assert_eq!(text, "[-0.234847058556, -1.410817700611]");
    }

    #[test]
    fn seed_and_stream_determine_the_noise() {
        let first = |seed, stream| Noise::new(seed, stream).next([1.0; 4]).map(f64::to_bits);
        assert_eq!(first(7, 3), first(7, 3));
        assert_ne!(first(7, 3), first(7, 4));
        assert_ne!(first(7, 3), first(8, 3));
    }
}
