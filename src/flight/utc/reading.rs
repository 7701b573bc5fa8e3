//! Absolute times, and findings about pulses and times.

/// An instant of UTC.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct UtcTime {
    /// Microseconds since 1970-01-01T00:00:00 UTC, leap seconds not counted.
    pub unix_us: u64,
    /// σ, s.
    pub sigma_s: f32,
}

/// Finding of a pulse or a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum UtcFinding {
    /// Number of pulses that did not come.
    MissingPulses(u32),
    /// A pulse that fits no second; not used.
    ExtraPulse,
    /// Pulses have come at another place in the second for long enough: they replace the earlier
    /// ones, and are not named yet. σ covers the move until the doubt is cleared.
    PulsesMoved,
    /// Number of seconds by which the receiver's time differs from the count of pulses; not used
    /// yet, and σ covers it.
    WrongSecond(i64),
    /// The same difference has lasted long enough to replace the count: a leap second, or a
    /// receiver that is wrong now or was before. σ covers it until the doubt is cleared.
    Stepped(i64),
    /// A pulse or a time that comes from before the last one; not used.
    FromThePast,
    /// A time without a pulse in the second before it; it names nothing.
    NoPulse,
}
