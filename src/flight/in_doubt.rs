//! Exposures whose principal points are in doubt.

/// The exposures since the last crossing of the index mark that agreed within the encoder's steps,
/// after one that did not agree; those since the last crossing, after one that agrees only because
/// uneven motion may explain its difference, but by more than their σ covers; those since the last
/// crossing against the FMC axis, after one which shows that the play has grown by more than that;
/// or one whose next crossing has not come.
///
/// Records that are still kept get [`Flag::Unreferenced`](super::flag::Flag::Unreferenced), where
/// [`Self::is_fault`] also [`Fault::Encoder`](super::fault::Fault::Encoder), and their σ covers
/// [`Self::off_mm`]. For those that have been acknowledged the receiver of the records does the
/// same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InDoubt {
    /// Sequence number of the first.
    pub from_sequence: u32,
    /// Reading of the encoder at the mark, less that of the crossing before, mm along the FMC axis,
    /// or σ of the counts that may be lost where no crossing has come: principal points may be
    /// wrong by as much.
    pub off_mm: f32,
    /// Number of triggers from the first to the last; [`u16::MAX`] stands for all since the first.
    pub triggers: u16,
    /// `true` if the crossing did not agree: fault 14. `false` if it did.
    pub is_fault: bool,
}

impl InDoubt {
    /// Returns the exposures from the first to the last sequence number.
    #[must_use]
    pub fn between(
        [from_sequence, through_sequence]: [u32; 2],
        off_mm: f32,
        is_fault: bool,
    ) -> Self {
        let triggers = through_sequence
            .saturating_add(1)
            .saturating_sub(from_sequence);
        Self {
            from_sequence,
            off_mm,
            triggers: u16::try_from(triggers).unwrap_or(u16::MAX),
            is_fault,
        }
    }

    /// Sequence number of the last.
    #[must_use]
    pub fn through_sequence(&self) -> u32 {
        if self.triggers == u16::MAX {
            return u32::MAX;
        }
        let end = self.from_sequence.saturating_add(u32::from(self.triggers));
        end.saturating_sub(1)
    }

    /// Returns `true` if an exposure is among them.
    #[must_use]
    pub fn contains(&self, sequence: u32) -> bool {
        (self.from_sequence..=self.through_sequence()).contains(&sequence)
    }

    /// Returns the exposures of both and those between, with the larger difference, and a fault if
    /// either is one.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let larger = if libm::fabsf(other.off_mm) > libm::fabsf(self.off_mm) {
            other
        } else {
            self
        };
        let from = self.from_sequence.min(other.from_sequence);
        let through = self.through_sequence().max(other.through_sequence());
        let is_fault = self.is_fault || other.is_fault;
        Self::between([from, through], larger.off_mm, is_fault)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_both_are_joined() {
        let one = InDoubt::between([3, 5], -0.01, true);
        let other = InDoubt::between([8, 8], 0.002, false);
        assert_eq!([one.triggers, other.triggers], [3, 1]);
        let both = other.with(one);
        assert_eq!(both, InDoubt::between([3, 8], -0.01, true));
        let found = [2, 3, 8, 9].map(|sequence| both.contains(sequence));
        assert_eq!(found, [false, true, true, false]);
    }

    #[test]
    fn more_than_can_be_counted_have_no_end() {
        let most = InDoubt::between([7, 70_000], 0.01, false);
        assert!(most.contains(u32::MAX) && !most.contains(6));
        let counted = InDoubt::between([7, 65_540], 0.01, false);
        assert!(counted.contains(65_540) && !counted.contains(65_541));
        let ended = InDoubt::between([7, 6], 0.01, false);
        assert!(!ended.contains(6) && !ended.contains(7));
    }

    /// An action is copied in every round.
    #[test]
    fn action_stays_small() {
        assert!(size_of::<InDoubt>() <= 12);
    }
}
