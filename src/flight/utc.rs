//! Absolute time.

/// An instant of UTC.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct UtcTime {
    /// Microseconds since 1970-01-01T00:00:00 UTC, leap seconds not counted.
    pub unix_us: u64,
    /// σ, s.
    pub sigma_s: f32,
}
