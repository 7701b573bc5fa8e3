//! V/H: from what the aircraft says of its speed and height, or given directly.

pub mod channel;
pub mod finding;
pub mod monitor;
pub mod settings;
#[cfg(test)]
mod tests;

pub use channel::CONSISTENT_SAMPLES;
pub use finding::{VhChannel, VhCounters, VhFinding, VhFindingKind, WrongUnit};
pub use monitor::VhMonitor;
pub use settings::{ChannelSettings, VhSettings};

/// Where a V/H comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum VhSource {
    /// Given as V/H.
    Direct,
    /// Ground speed over height from an altimeter.
    Altimeter,
    /// Ground speed over altitude less terrain height.
    Terrain,
}

/// What a sensor says.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum VhSample {
    /// V/H, 1/s.
    Direct(f32),
    /// Ground speed of the satellite receiver, m/s.
    GroundSpeed(f32),
    /// Height above the ground, from a radar altimeter, m.
    HeightAboveGround(f32),
    /// Altitude above sea level, m.
    Altitude(f32),
    /// Height of the terrain above sea level, m.
    TerrainHeight(f32),
    /// Ground speed of the inertial unit, m/s.
    InertialSpeed(f32),
    /// Height above the ground, from a laser altimeter, m.
    LaserHeight(f32),
}

/// V/H at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct VhEstimate {
    /// η = V/H, 1/s.
    pub vh_per_s: f32,
    /// σ of it, grown by its age, 1/s.
    pub sigma_per_s: f32,
    /// Age of the oldest sample in it, s.
    pub age_s: f32,
    /// Where it comes from.
    pub source: VhSource,
    /// Whether a source is silent for longer than its period, so that this is extrapolated.
    pub extrapolated: bool,
}
