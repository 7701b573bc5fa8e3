//! Counts of what was found of the aircraft's instruments.

use super::flag::Flag;

/// Kinds of findings.
const KINDS: usize = Flag::ALL.len() - FIRST;

/// The first flag that tells of an instrument.
const FIRST: usize = Flag::VhNotANumber as usize;

/// How often something was found of the aircraft's instruments, by the flag that tells it; a count
/// that is full stays so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Findings {
    counts: [u32; KINDS],
}

impl Findings {
    /// Nothing yet.
    pub const NONE: Self = Self { counts: [0; KINDS] };

    /// How often what a flag tells was found; `None` for a flag that tells nothing of an
    /// instrument.
    #[must_use]
    pub fn of(&self, flag: Flag) -> Option<u32> {
        self.counts.get(index(flag)?).copied()
    }

    /// Every flag that tells of an instrument, and how often what it tells was found.
    pub fn iter(&self) -> impl Iterator<Item = (Flag, u32)> {
        Flag::ALL
            .into_iter()
            .filter_map(|flag| Some((flag, self.of(flag)?)))
    }

    /// It was found so many times more.
    pub(super) fn count(&mut self, flag: Flag, times: u32) {
        if let Some(count) = index(flag).and_then(|index| self.counts.get_mut(index)) {
            *count = count.saturating_add(times);
        }
    }
}

const fn index(flag: Flag) -> Option<usize> {
    (flag as usize).checked_sub(FIRST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flag_of_an_instrument_has_its_count_and_a_full_one_stays_so() {
        let mut findings = Findings::NONE;
        let of_instruments = || Flag::ALL.into_iter().filter(|it| it.is_of_instrument());
        for (times, flag) in (1..).zip(of_instruments()) {
            findings.count(flag, times);
        }
        let counts: std::vec::Vec<_> = findings.iter().collect();
        assert!(counts.into_iter().eq(of_instruments().zip(1..)));
        findings.count(Flag::VhJump, u32::MAX);
        assert_eq!(findings.of(Flag::VhJump), Some(u32::MAX));
        findings.count(Flag::EncoderGlitch, 1);
        assert_eq!(findings.of(Flag::EncoderGlitch), None);
    }
}
