//! Counts of the findings of the aircraft's instruments.

use super::flag::Flag;

/// Kinds of findings.
const KINDS: usize = Flag::VhUnconfirmed as usize + 1 - FIRST;

/// First flag of an instrument.
const FIRST: usize = Flag::VhNotANumber as usize;

/// The last finding of an instrument of the aircraft.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LastFinding {
    /// Its flag.
    pub flag: Flag,
    /// Time since then, s.
    pub age_s: f32,
}

/// Counts of the findings of the aircraft's instruments, by their flags; a count that is full stays
/// so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Findings {
    counts: [u32; KINDS],
}

impl Findings {
    /// Counts of zero.
    pub const NONE: Self = Self { counts: [0; KINDS] };

    /// Count of a flag's finding; `None` for a flag that concerns no instrument.
    #[must_use]
    pub fn of(&self, flag: Flag) -> Option<u32> {
        self.counts.get(index(flag)?).copied()
    }

    /// Returns every flag of an instrument, with the count of its finding.
    pub fn iter(&self) -> impl Iterator<Item = (Flag, u32)> {
        Flag::ALL
            .into_iter()
            .filter_map(|flag| Some((flag, self.of(flag)?)))
    }

    /// Adds to the count of a flag.
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
