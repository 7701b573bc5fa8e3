//! CRC-32 of the residual grids of a camera.

use super::header::GridCarrier;

/// CRC-32 with which the file of each residual grid of a camera ends; `None` for a part without.
///
/// They make the grids a part of the camera's identity: a camera that has another grid in its
/// memory, or none, is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GridChecksums {
    /// That of the grid of the lens.
    pub lens: Option<u32>,
    /// That of the grid of the sensor.
    pub sensor: Option<u32>,
}

impl GridChecksums {
    /// Those of a camera without grids.
    pub const NONE: Self = Self {
        lens: None,
        sensor: None,
    };

    /// Returns that of the grid of a part.
    #[must_use]
    pub const fn of(self, carrier: GridCarrier) -> Option<u32> {
        match carrier {
            GridCarrier::Lens => self.lens,
            GridCarrier::Sensor => self.sensor,
        }
    }

    /// Returns true for a camera without grids.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.lens.is_none() && self.sensor.is_none()
    }
}
