//! Seeded Gaussian noise.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Noise of standard deviation 1 on x and y of `points` points, in their order.
///
/// The generator is [`ChaCha8Rng`], whose output is the same on every machine; normal
/// deviates by the ziggurat method of `rand_distr` with functions of `libm`.
#[must_use]
pub fn standard(seed: u64, points: usize) -> Vec<[f64; 2]> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    (0..points)
        .map(|_| [(); 2].map(|()| StandardNormal.sample(&mut generator)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_standard_and_repeatable() {
        let noise = standard(1, 20_000);
        let (sum, squares) = noise
            .iter()
            .flatten()
            .fold((0.0, 0.0), |(sum, squares), e| (sum + e, squares + e * e));
        // Four standard errors of 40 000 deviates.
        assert!((sum / 4e4_f64).abs() < 0.02, "{sum}");
        assert!((squares / 4e4_f64 - 1.0).abs() < 0.028, "{squares}");
        assert_eq!(noise, standard(1, 20_000));
        assert_ne!(noise, standard(2, 20_000));
    }

    #[test]
    fn noise_of_a_seed_never_changes() {
        let text = format!("{:.12?}", standard(1, 1));
        assert_eq!(text, "[[-0.234847058556, -1.410817700611]]");
    }
}
