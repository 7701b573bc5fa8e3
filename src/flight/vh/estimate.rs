//! V/H at an instant.

/// Source of a V/H.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VhSource {
    /// Given as V/H.
    Direct,
    /// Ground speed over height from an altimeter.
    Altimeter,
    /// Ground speed over altitude less terrain height.
    Terrain,
}

/// V/H at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VhEstimate {
    /// η = V/H, 1/s.
    pub vh_per_s: f32,
    /// σ of V/H, grown by its age, 1/s.
    pub sigma_per_s: f32,
    /// Age of the oldest sample in it, s.
    pub age_s: f32,
    /// Source of this V/H.
    pub source: VhSource,
    /// `true` if a source is silent for longer than its period, so that this is extrapolated.
    pub extrapolated: bool,
}
