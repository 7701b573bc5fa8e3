//! Exposures whose principal points are in doubt.

/// The exposures since the last crossing of the index mark that agreed within the encoder's steps,
/// after one that did not agree.
///
/// Records that are still kept get [`Flag::Unreferenced`](super::flag::Flag::Unreferenced) and
/// [`Fault::Encoder`](super::fault::Fault::Encoder), and their σ covers [`Self::off_mm`]. For those
/// that have been acknowledged the receiver of the records does the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InDoubt {
    /// Sequence number of the first.
    pub from_sequence: u32,
    /// Reading of the encoder at the mark, less that of the crossing before, mm along the FMC axis:
    /// principal points may be wrong by as much.
    pub off_mm: f32,
}
