//! Pairs of faults, drawn by seed.

use super::case::Case;
use super::run::Delayed;
use super::world::{INTERVAL_MS, TICKS, World};
use crate::noise::Noise;

/// Stream of a seed from which pairs are drawn; each has its own.
const STREAM: u64 = 0x7061_0000_0000;

/// Two faults, the second at most a frame cycle after the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// World in which it is flown.
    pub world: World,
    /// Tick of the first fault.
    pub tick: u32,
    /// The faults.
    pub faults: [Delayed; 2],
}

impl Pair {
    /// Draws a pair by its number; `None` without cases.
    #[must_use]
    pub fn draw(cases: &[Case], seed: u64, number: u32) -> Option<Self> {
        let mut noise = Noise::new(seed, STREAM + u64::from(number));
        let [one, other] = [
            below(&mut noise, cases.len()),
            below(&mut noise, cases.len()),
        ];
        let [one, other] = [*cases.get(one)?, *cases.get(other)?];
        let tick = below(&mut noise, to_size(TICKS));
        let after = below(&mut noise, to_size(INTERVAL_MS));
        // Every world has the first source. A second one is there where either fault needs it, and
        // the flight is then along the FMC axis, also for a fault that alone is tried against it.
        Some(Self {
            world: world(one.world, other.world),
            tick: u32::try_from(tick).ok()?,
            faults: [(one, 0), (other, u32::try_from(after).ok()?)],
        })
    }
}

const fn world(one: World, other: World) -> World {
    match (one, other) {
        (World::TwoSources, _) | (_, World::TwoSources) => World::TwoSources,
        (World::Reverse, _) | (_, World::Reverse) => World::Reverse,
        (World::OneSource, World::OneSource) => World::OneSource,
    }
}

fn to_size(number: u32) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "from 0 to below the limit, which is small"
)]
fn below(noise: &mut Noise, limit: usize) -> usize {
    (noise.between(0.0, limit as f64) as usize).min(limit.saturating_sub(1))
}
