//! Exposures whose principal points are in doubt.

/// The exposures since the last crossing of the index mark that agreed within the encoder's steps,
/// after one that did not agree; or those since the last crossing, after one that agrees only
/// because uneven motion may explain its difference, but by more than their σ covers.
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
    /// Sequence number of the last.
    pub through_sequence: u32,
    /// Reading of the encoder at the mark, less that of the crossing before, mm along the FMC axis:
    /// principal points may be wrong by as much.
    pub off_mm: f32,
    /// `true` if the crossing did not agree: fault 14. `false` if it did.
    pub is_fault: bool,
}

impl InDoubt {
    /// Returns `true` if an exposure is among them.
    #[must_use]
    pub const fn contains(&self, sequence: u32) -> bool {
        self.from_sequence <= sequence && sequence <= self.through_sequence
    }

    /// Returns the exposures of both and those between, with the larger difference.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let larger = if libm::fabsf(other.off_mm) > libm::fabsf(self.off_mm) {
            other
        } else {
            self
        };
        Self {
            from_sequence: self.from_sequence.min(other.from_sequence),
            through_sequence: self.through_sequence.max(other.through_sequence),
            off_mm: larger.off_mm,
            is_fault: self.is_fault || other.is_fault,
        }
    }
}
