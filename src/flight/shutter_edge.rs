//! Edges of the shutter's sensor.

/// An edge of the shutter's sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShutterEdge {
    /// First light.
    Opened,
    /// Last light.
    Closed,
}
