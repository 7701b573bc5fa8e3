//! Random numbers of tests.

/// Source of repeatable Gaussian noise.
pub(crate) struct Noise(fastrand::Rng);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// Evenly distributed between -1 and 1.
    pub(crate) fn even(&mut self) -> f64 {
        2.0 * self.0.f64() - 1.0
    }

    /// Gaussian with unit σ (Box and Muller).
    pub(crate) fn gaussian(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.0.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.0.f64()).cos()
    }
}

/// Half of the width of the interval that holds a share of `trials` with the probability 99.9 % if
/// each has the probability of one σ, 68.27 %.
pub(crate) fn binomial_half_width(trials: f64) -> f64 {
    3.2905 * (0.6827_f64 * 0.3173 / trials).sqrt()
}
