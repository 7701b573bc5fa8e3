//! Random choices from a seed.

use crate::noise::Noise;

/// Source of choices.
#[derive(Debug, Clone)]
pub(super) struct Random(Noise);

impl Random {
    /// Creates the source of a mission.
    pub(super) fn new(seed: u64, mission: u64) -> Self {
        Self(Noise::new(seed, 0x5747_0000 + mission))
    }

    /// Returns a number that is evenly distributed.
    pub(super) fn between(&mut self, least: f64, most: f64) -> f64 {
        self.0.between(least, most)
    }

    /// Returns a number whose logarithm is evenly distributed.
    pub(super) fn scaled(&mut self, least: f64, most: f64) -> f64 {
        self.0.between(least.ln(), most.ln()).exp()
    }

    /// Returns a whole number from 0 to below a limit.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to below the limit"
    )]
    pub(super) fn below(&mut self, limit: u32) -> u32 {
        (self.0.between(0.0, f64::from(limit)) as u32).min(limit.saturating_sub(1))
    }

    /// Returns true with a probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.between(0.0, 1.0) < probability
    }

    /// Returns one of the values.
    pub(super) fn of<T: Copy>(&mut self, values: &[T], otherwise: T) -> T {
        let count = u32::try_from(values.len()).unwrap_or(0);
        let index = usize::try_from(self.below(count)).unwrap_or(0);
        values.get(index).copied().unwrap_or(otherwise)
    }
}
