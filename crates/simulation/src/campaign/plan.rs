//! Plan of a campaign: its runs, in blocks that are flown and stored together.

use std::fmt::Write;

use serde::Serialize;

use super::case::Case;
use super::pair::Pair;
use super::run::Delayed;
use super::world::{TICKS, World};
use crate::mission::fault::InjectedFault;

/// Number of pairs in a block.
const PAIRS_IN_A_BLOCK: u32 = 500;
/// Part of the runs that a quick campaign flies: one of so many.
const QUICK: u64 = 20;

/// A request.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Request {
    /// Seed of the world, of the pairs and of the choice of a quick campaign.
    pub seed: u64,
    /// Number of pairs of the whole campaign.
    pub pairs: u32,
    /// `true` if a twentieth is flown, which the seed selects.
    pub quick: bool,
    /// Part of what its record allows beyond which an exposure is counted as silently bad.
    pub allowed: f64,
}

/// Runs that are flown and stored together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Block {
    /// All cases in one round of the cycle.
    Tick(u32),
    /// Pairs from this number on.
    Pairs(u32),
}

/// A run: its number, and the faults with the round in which the first begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Number: of the case in a tick, or of the pair.
    pub number: u32,
    /// World in which it is flown.
    pub world: World,
    /// Round of the cycle.
    pub tick: u32,
    /// The faults.
    pub faults: Vec<Delayed>,
}

impl Run {
    /// Describes the faults: name, size, duration if they end, delay of the second, and the
    /// direction of the flight if it is against the FMC axis.
    #[must_use]
    pub fn description(&self) -> String {
        let faults = self.faults.iter().map(|(case, after)| {
            let mut text = format!("{} {}", case.name(), case.size);
            // Writing to a string does not fail.
            if case.duration_s.is_finite() {
                let _ = write!(text, " for {} s", case.duration_s);
            }
            if *after > 0 {
                let _ = write!(text, " after {after} ms");
            }
            text
        });
        let faults = faults.collect::<Vec<_>>().join(" + ");
        match self.world {
            World::Reverse => faults + ", reverse",
            World::OneSource | World::TwoSources => faults,
        }
    }
}

/// Runs of a campaign.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The request.
    pub request: Request,
    /// Cases, fault by fault.
    pub cases: Vec<Case>,
}

impl Plan {
    /// Creates the plan of a request, with the cases of some faults alone, if any are given.
    #[must_use]
    pub fn new(request: Request, faults: &[InjectedFault]) -> Self {
        let mut cases = Case::all();
        cases.retain(|case| faults.is_empty() || faults.contains(&case.fault));
        Self { request, cases }
    }

    /// Returns the blocks, in order.
    #[must_use]
    pub fn blocks(&self) -> Vec<Block> {
        let ticks = (0..TICKS).map(Block::Tick);
        let pairs = (0..self.request.pairs.div_ceil(PAIRS_IN_A_BLOCK))
            .map(|block| Block::Pairs(block * PAIRS_IN_A_BLOCK));
        ticks.chain(pairs).collect()
    }

    /// Returns the runs of a block, in order.
    #[must_use]
    pub fn runs(&self, block: Block) -> Vec<Run> {
        match block {
            Block::Tick(tick) => (0_u32..)
                .zip(&self.cases)
                .filter(|(number, _)| self.is_chosen(0, u64::from(tick), u64::from(*number)))
                .map(|(number, case)| Run {
                    number,
                    world: case.world,
                    tick,
                    faults: vec![(*case, 0)],
                })
                .collect(),
            Block::Pairs(first) => {
                let end = (first + PAIRS_IN_A_BLOCK).min(self.request.pairs);
                (first..end)
                    .filter(|number| self.is_chosen(1, 0, u64::from(*number)))
                    .filter_map(|number| {
                        let pair = Pair::draw(&self.cases, self.request.seed, number)?;
                        Some(Run {
                            number,
                            world: pair.world,
                            tick: pair.tick,
                            faults: pair.faults.to_vec(),
                        })
                    })
                    .collect()
            }
        }
    }

    /// Returns true for every run, or for the twentieth that the seed selects.
    fn is_chosen(&self, kind: u64, row: u64, column: u64) -> bool {
        let number = (kind << 62) ^ (row << 32) ^ column;
        !self.request.quick || mixed(self.request.seed ^ mixed(number)).is_multiple_of(QUICK)
    }

    /// Returns the check sum of all cases: another list of faults is another campaign.
    #[must_use]
    pub fn check_sum(&self) -> u32 {
        let mut text = String::new();
        for case in &self.cases {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{case:?}");
        }
        for world in World::ALL {
            text += &world.scenario_text();
        }
        crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(text.as_bytes())
    }
}

/// Mixes the bits of a number: the finaliser of `SplitMix64` (Steele et al. 2014).
const fn mixed(number: u64) -> u64 {
    let mut bits = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(quick: bool) -> Plan {
        let request = Request {
            seed: 1,
            pairs: 100_000,
            quick,
            allowed: 1.0,
        };
        Plan::new(request, &[])
    }

    fn counts(plan: &Plan) -> [usize; 2] {
        let mut counts = [0, 0];
        for block in plan.blocks() {
            let kind = usize::from(matches!(block, Block::Pairs(_)));
            counts[kind] += plan.runs(block).len();
        }
        counts
    }

    #[test]
    fn whole_campaign_has_250_000_runs_and_every_pair_and_a_quick_one_a_twentieth() {
        let [runs, pairs] = counts(&plan(false));
        assert!(runs >= 250_000, "{runs}");
        assert_eq!(pairs, 100_000);
        let [some_runs, some_pairs] = counts(&plan(true));
        // Four standard deviations of a binomial distribution.
        for (some, all) in [(some_runs, 250_000.0), (some_pairs, 100_000.0)] {
            let some = f64::from(u32::try_from(some).unwrap());
            assert!(some > all / 20.0 - 4.0 * (all / 20.0_f64).sqrt(), "{some}");
        }
        assert!(some_pairs < 5300 && some_runs < runs / 18);
    }

    #[test]
    fn pairs_of_a_seed_are_the_same_and_those_of_another_are_others() {
        let cases = Case::all();
        let draw = |seed| Pair::draw(&cases, seed, 7);
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }
}
