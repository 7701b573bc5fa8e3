//! The index mark on the stage, and the sensor that sees it.

use super::settings::MechanicsSettings;
use crate::noise::Noise;

/// Stream of the noise of all marks.
const STREAM: u64 = 201;

/// A mark of some width. The sensor gives an edge where the stage comes to it, from either side.
#[derive(Debug, Clone)]
pub(super) struct IndexMark {
    noise: Noise,
    /// Deviation of the place of the next edge, mm.
    deviation_mm: f64,
}

impl IndexMark {
    /// Creates a mark whose first edge is in its place.
    pub(super) fn new() -> Self {
        Self {
            noise: Noise::new(0, STREAM),
            deviation_mm: 0.0,
        }
    }

    /// Returns the time of the edge that a short way of the stage leads to, s; times, s, and places
    /// of the stage, mm, at both ends.
    pub(super) fn edge_s(
        &mut self,
        settings: &MechanicsSettings,
        [(from_s, from_mm), (to_s, to_mm)]: [(f64, f64); 2],
    ) -> Option<f64> {
        let low_mm = settings.index_mm + self.deviation_mm;
        let high_mm = low_mm + 1e-3 * settings.index_width_um;
        let edge_mm = if from_mm < low_mm && to_mm >= low_mm {
            low_mm
        } else if from_mm > high_mm && to_mm <= high_mm {
            high_mm
        } else {
            return None;
        };
        if !settings.has_index {
            return None;
        }
        let [deviation_um] = self.noise.next([settings.index_noise_um]);
        self.deviation_mm = 1e-3 * deviation_um;
        Some(from_s + (to_s - from_s) * (edge_mm - from_mm) / (to_mm - from_mm))
    }
}
